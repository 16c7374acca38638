//! Which grid is asked for on the command line, in the user's own terms.

use super::unit::{Length, Unit, unit_parser};
use crate::cli::exit::Failure;
use crate::cli::stream::StreamSource;
use anyhow::Context;
use lwc::io::Format;
use lwc::mesh::SceneTable;
use lwc::{GridChoice, Lattice};
use std::path::{Path, PathBuf};

/// Steps and precision in model units, in place of `-q`.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Grid (in place of -q)")]
pub struct GridArgs {
    /// Round to multiples of STEP, in units of the model, above 0; one for all axes or one each. The bits follow from
    /// the extent of the mesh.
    #[arg(long, value_name = "STEP|X,Y,Z", value_parser = steps, allow_hyphen_values = true)]
    #[arg(conflicts_with_all = ["quantization_bits", "precision", "grid", "cubic_grid"])]
    pub step: Option<Steps>,
    /// Move no coordinate by more than LENGTH: steps of twice that. In units of the model, or as 1mm, 0.5cm or 0.01in.
    ///
    /// A length with a unit needs the unit of the model: glTF is in metres, for all other files say it with `--unit`. In a
    /// scene it holds for every instance.
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true)]
    #[arg(conflicts_with_all = ["quantization_bits", "grid", "cubic_grid"])]
    pub precision: Option<Length>,
    /// Unit of the model's coordinates, for a `--precision` with a unit.
    #[arg(long, value_name = "UNIT", requires = "precision", value_parser = unit_parser())]
    pub unit: Option<Unit>,
    /// Round to the lattice through ORIGIN, three numbers, with STEP, one number or three; or to that of another stream.
    ///
    /// Meshes encoded with one lattice, such as tiles of a terrain, share their borders bit for bit. The origin may be
    /// anywhere, also outside of the mesh. An example is 0,0,0,0.001. Of a stream with the cubic grid of -q its origin and
    /// step are taken; its own vertices are at these places but for the rounding of doubles.
    #[arg(long, value_name = "ORIGIN,STEP|FILE.lwc", value_parser = lattice, allow_hyphen_values = true)]
    #[arg(conflicts_with_all = ["quantization_bits", "cubic_grid"])]
    pub grid: Option<GridOf>,
    /// Keep the cubic grid of -q even if more than 1 % of the triangles collapse or turn over in it. Without this option
    /// each axis then divides its own extent, if that helps.
    #[arg(long)]
    pub cubic_grid: bool,
}

/// Where the lattice is from.
#[derive(Clone, Debug, PartialEq)]
pub enum GridOf {
    Numbers(Lattice),
    Stream(PathBuf),
}

/// Steps along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steps(pub [f64; 3]);

/// What is asked for, before the mesh is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Asked {
    Grid(GridChoice),
    /// The largest error of a coordinate, units of the scene.
    Precision(f64),
}

impl GridArgs {
    /// What the options ask for; `input` is the model.
    ///
    /// # Errors
    /// If the unit of the model is not known, or the stream with the grid cannot be read.
    pub fn asked(&self, input: &Path) -> anyhow::Result<Asked> {
        if let Some(length) = self.precision {
            return Ok(Asked::Precision(self.in_model_units(length, input)?));
        }
        let choice = match (&self.grid, self.step) {
            (Some(GridOf::Numbers(lattice)), _) => GridChoice::Lattice(*lattice),
            (Some(GridOf::Stream(path)), _) => GridChoice::Lattice(lattice_of(path)?),
            (None, Some(Steps(step))) => GridChoice::step(step),
            (None, None) if self.cubic_grid => GridChoice::Cube,
            (None, None) => GridChoice::Auto,
        };
        Ok(Asked::Grid(choice))
    }

    fn in_model_units(&self, length: Length, input: &Path) -> Result<f64, Failure> {
        let Some(unit) = length.unit else {
            return match self.unit {
                None => Ok(length.number),
                Some(_) => Err(Failure::Usage("--unit needs a --precision with a unit, such as 1mm".into())),
            };
        };
        let model = self.unit.or_else(|| unit_of(input));
        let model = model.ok_or_else(|| Failure::Usage(unknown_unit(length, input)))?;
        Ok(length.number * unit.metres() / model.metres())
    }
}

impl Asked {
    /// The option of the library. `scene`: that of the model, if it has one.
    pub fn choice(self, scene: Option<&SceneTable>) -> GridChoice {
        match self {
            Self::Grid(choice) => choice,
            Self::Precision(precision) => {
                let stretch = scene.map_or(1.0, largest_stretch);
                GridChoice::step([2.0 * precision / stretch; 3])
            }
        }
    }
}

/// How much more a coordinate of an instance may be off than those of its mesh as the stream has it.
fn largest_stretch(scene: &SceneTable) -> f64 {
    let of_instance = |instance: &lwc::mesh::Instance| {
        let exponent = scene.exponents.get(instance.mesh).copied().unwrap_or(0);
        let of_row = |row: &[f64; 4]| row[..3].iter().map(|x| x.abs()).sum::<f64>();
        instance.transform.iter().map(of_row).fold(0.0, f64::max) * 2_f64.powi(-i32::from(exponent))
    };
    let largest = scene.instances.iter().map(of_instance).fold(0.0, f64::max);
    if largest > 0.0 && largest.is_finite() { largest } else { 1.0 }
}

/// The unit that the format prescribes.
fn unit_of(input: &Path) -> Option<Unit> {
    matches!(Format::from_path(input), Some(Format::Glb | Format::Gltf)).then_some(Unit::METRE)
}

fn unknown_unit(length: Length, input: &Path) -> String {
    let files = match Format::from_path(input) {
        Some(Format::Las | Format::Laz) => "LAS files have metres, feet or degrees",
        _ => "the file does not say it",
    };
    let Length { number, .. } = length;
    let unit = length.unit.map_or("", Unit::name);
    format!(
        "--precision {number}{unit} needs the unit of the model, and {files}: add --unit m, cm, mm, in or ft"
    )
}

/// The lattice of another stream.
fn lattice_of(path: &Path) -> anyhow::Result<Lattice> {
    let source = StreamSource::new(Some(path))?;
    let info = source.read_info().with_context(|| source.name())?;
    let lattice = info.lattice().unwrap_or(Lattice { origin: info.origin(), step: info.step() });
    if lattice.step.iter().any(|&step| step <= 0.0) {
        return Err(Failure::Usage("its grid is a single point".into())).with_context(|| source.name());
    }
    Ok(lattice)
}

/// Numbers between commas, if all are.
fn numbers(text: &str) -> Option<Vec<f64>> {
    text.split(',').map(|part| part.trim().parse().ok().filter(|x: &f64| x.is_finite())).collect()
}

/// One step or three, all above 0.
fn steps_from(numbers: &[f64]) -> Option<[f64; 3]> {
    let step = match *numbers {
        [step] => [step; 3],
        [x, y, z] => [x, y, z],
        _ => return None,
    };
    Some(step).filter(|step| step.iter().all(|&s| s > 0.0))
}

fn steps(text: &str) -> Result<Steps, String> {
    let step = numbers(text).and_then(|numbers| steps_from(&numbers));
    step.map(Steps).ok_or_else(|| "it is neither one number above 0 nor three with commas between".into())
}

fn length(text: &str) -> Result<Length, String> {
    Length::parse(text).ok_or_else(|| "it is no length above 0 like 0.001, 1mm or 0.5in".into())
}

fn lattice(text: &str) -> Result<GridOf, String> {
    let Some(numbers) = numbers(text) else { return Ok(GridOf::Stream(text.into())) };
    let lattice = numbers.split_first_chunk().and_then(|(&origin, step)| {
        let step = steps_from(step)?;
        Some(Lattice { origin, step })
    });
    lattice
        .map(GridOf::Numbers)
        .ok_or_else(|| "it is neither x,y,z and one step or three, such as 0,0,0,0.001, nor a stream".into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use lwc::mesh::{IDENTITY, Instance};

    #[test]
    fn steps_are_one_or_three() {
        assert_eq!(steps("0.5"), Ok(Steps([0.5; 3])));
        assert_eq!(steps("1, 2,3e-3"), Ok(Steps([1.0, 2.0, 3e-3])));
        for wrong in ["", "0", "-1", "1,2", "1,2,3,4", "1,0,1", "nan", "inf", "1mm"] {
            assert!(steps(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_lattice_is_numbers_or_a_stream() {
        let numbers = |origin, step| Ok(GridOf::Numbers(Lattice { origin, step }));
        assert_eq!(lattice("-1,2,0,0.5"), numbers([-1.0, 2.0, 0.0], [0.5; 3]));
        assert_eq!(lattice("1,2,3,4,5,6"), numbers([1.0, 2.0, 3.0], [4.0, 5.0, 6.0]));
        assert_eq!(lattice("a,b.lwc"), Ok(GridOf::Stream("a,b.lwc".into())));
        for wrong in ["1,2,3", "1,2,3,0", "1,2,3,-4", "1,2,3,4,5", "7"] {
            assert!(lattice(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_precision_holds_for_every_instance() {
        let [x, y, z] = IDENTITY;
        let place = |mesh, transform| Instance { mesh, name: String::new(), transform };
        let threefold = [[3.0, 0.0, 0.0, 9.0], y, z];
        let turned = [[0.8, -0.6, 0.0, 1.0], [0.6, 0.8, 0.0, 0.0], z];
        let choice = |exponents: Vec<i8>, instances| {
            Asked::Precision(0.6).choice(Some(&SceneTable { exponents, instances }))
        };
        assert_eq!(choice(vec![0], vec![place(0, [x, y, z])]), GridChoice::step([1.2; 3]));
        let both = vec![place(0, threefold), place(1, [x, y, z])];
        assert_eq!(choice(vec![1, 0], both), GridChoice::step([1.2 / 1.5; 3]));
        assert_eq!(choice(vec![0], vec![place(0, turned)]), GridChoice::step([1.2 / 1.4; 3]));
        assert_eq!(choice(vec![0], Vec::new()), GridChoice::step([1.2; 3]));
    }
}
