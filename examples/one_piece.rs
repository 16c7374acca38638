//! Sizes and decoding speed of whole meshes in one piece: `one_piece [RUNS] MESH...` prints for the profiles fast and small
//! the bits per vertex and the million vertices per second of processor time that decoding takes, the best of RUNS (default 5). For one thread: RAYON_NUM_THREADS=1.

use lwc::{DecodeOptions, EncodeOptions, Profile, TriMesh, decode, encode};
use std::error::Error;
use std::time::Duration;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let runs =
        arguments.first().and_then(|runs| runs.parse().ok()).inspect(|_: &u32| drop(arguments.remove(0)));
    println!(
        "{:24} {:>8} {:>9} {:>8} {:>9} {:>8}",
        "mesh", "vertices", "fast bpv", "Mv/s", "small bpv", "Mv/s"
    );
    for path in &arguments {
        let mesh = lwc::io::read(path)?.mesh;
        let mut row = String::new();
        for profile in [Profile::Fast, Profile::Small] {
            let (size, time) = measure(&mesh, profile, runs.unwrap_or(5))?;
            let vertices = mesh.num_vertices() as f64;
            row += &format!(
                " {:>9.3} {:>8.3}",
                size as f64 * 8.0 / vertices,
                vertices / time.as_secs_f64() / 1e6
            );
        }
        let name = path.rsplit('/').next().unwrap_or(path);
        println!("{name:24} {:>8}{row}", mesh.num_vertices());
    }
    Ok(())
}

/// Bytes of the stream of a mesh in one piece, and the least time that decoding took.
fn measure(mesh: &TriMesh, profile: Profile, runs: u32) -> Result<(usize, Duration), Box<dyn Error>> {
    let mut options = EncodeOptions::default();
    (options.levels, options.profile) = (Some(0), Some(profile));
    let stream = encode(mesh, &options)?.bytes;
    let mut least = Duration::MAX;
    for _ in 0..runs {
        let start = processor_time();
        let decoded = decode(&stream, DecodeOptions::new())?;
        least = least.min(processor_time() - start);
        drop(decoded);
    }
    Ok((stream.len(), least))
}

/// Time that this process has computed so far: others do not count.
#[cfg(unix)]
fn processor_time() -> Duration {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Duration::new(now.tv_sec as u64, now.tv_nsec as u32)
}

#[cfg(not(unix))]
fn processor_time() -> Duration {
    std::time::UNIX_EPOCH.elapsed().unwrap_or_default()
}
