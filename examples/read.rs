//! Reads mesh files and says how long each took, the least of some runs:
//! `cargo run --release --example read -- 5 model.obj model.ply`

use lwc::io;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let runs: u32 = arguments.next().ok_or("usage: read RUNS FILE…")?.parse()?;
    for path in arguments {
        let mut least = f64::INFINITY;
        let mut size = (0, 0);
        for _ in 0..runs {
            let start = Instant::now();
            let file = io::read(&path)?;
            least = least.min(start.elapsed().as_secs_f64());
            size = (file.mesh.num_vertices(), file.mesh.num_triangles());
        }
        println!("{path}: {} vertices, {} triangles, {least:.3} s", size.0, size.1);
    }
    Ok(())
}
