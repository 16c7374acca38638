//! What is said of the grid of a stream.

use lwc::{GridChoice, StreamInfo};

/// `2.44e-4`, or one for each axis.
pub fn step(step: [f64; 3]) -> String {
    let [x, y, z] = step.map(|step| format!("{step:.2e}"));
    if step == [step[0]; 3] { x } else { format!("{x}, {y}, {z}") }
}

/// What the encoder chose by itself.
pub fn note(asked: GridChoice, info: &StreamInfo) -> Option<&'static str> {
    let is_own_choice = asked == GridChoice::Auto && info.lattice().is_some();
    is_own_choice.then_some(
        "each axis has its own step: on a cubic grid more than 1 % of the triangles collapse or turn over",
    )
}
