//! Reads a mesh file and writes it in another format, with all attributes that both can hold:
//! `cargo run --release --example convert -- model.obj model.glb`

use lwc::io;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(from), Some(to), None) = (arguments.next(), arguments.next(), arguments.next()) else {
        return Err("usage: convert FROM TO".into());
    };
    let file = io::read(&from)?;
    let losses = io::write_with_attributes(&to, &file.mesh, &file.attributes)?;
    let names = |names: &[String]| if names.is_empty() { "nothing".to_owned() } else { names.join(", ") };
    let (vertices, triangles) = (file.mesh.num_vertices(), file.mesh.num_triangles());
    println!("{to}: {vertices} vertices, {triangles} triangles");
    println!("not read: {}", names(&file.report.ignored));
    losses.iter().for_each(|loss| println!("writing: {loss}"));
    Ok(())
}
