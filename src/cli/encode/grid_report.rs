//! What is said of the grid of a stream.

use super::args::Encode;
use lwc::{GridChoice, GridError, Remedy, StreamInfo};

/// `2.44e-4`, or one for each axis.
pub fn step(step: [f64; 3]) -> String {
    let [x, y, z] = step.map(|step| format!("{step:.2e}"));
    if step == [step[0]; 3] { x } else { format!("{x}, {y}, {z}") }
}

/// A warning if the grid takes too many triangles, with what to type.
pub fn warning(error: &GridError, args: &Encode) -> Option<String> {
    if !error.is_too_coarse() {
        return None;
    }
    let advice = match error.remedy {
        Some(Remedy::Bits(bits)) => format!("`-q {bits}` keeps them"),
        Some(Remedy::Step([x, y, z])) if args.grid.grid.is_some() => {
            format!("steps of {x}, {y}, {z} keep them")
        }
        Some(Remedy::Step([x, y, z])) if x == y && y == z => format!("`--step {x}` keeps them"),
        Some(Remedy::Step([x, y, z])) => format!("`--step {x},{y},{z}` keeps them"),
        _ => "`--lossless` keeps them".to_owned(),
    };
    let (lost, all) = (error.triangles_lost(), error.num_triangles);
    Some(format!(
        "{lost} of {all} triangles collapse or turn over on the grid, which is too coarse: {advice}"
    ))
}

/// What the encoder chose by itself.
pub fn note(asked: GridChoice, info: &StreamInfo) -> Option<&'static str> {
    let is_own_choice = asked == GridChoice::Auto && info.lattice().is_some();
    is_own_choice.then_some(
        "each axis has its own step: on a cubic grid more than 1 % of the triangles collapse or turn over",
    )
}
