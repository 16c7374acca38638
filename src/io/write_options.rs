//! How mesh files are written.

/// The type that positions have in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum PositionType {
    /// float32 where that is as good, else float64; see [`WriteOptions::step`].
    #[default]
    Auto,
    /// float32.
    Float,
    /// float64.
    Double,
}

/// The type that colours have in PLY.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ColorType {
    /// 0 to 255 in a byte, what most programs read.
    #[default]
    Uchar,
    /// 0 to 65,535 in two bytes.
    Ushort,
    /// 0 to 1 as float32.
    Float,
    /// The type that they have.
    Keep,
}

/// The colour space of written colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ColorSpace {
    /// That of the format: linear in glTF, sRGB elsewhere. Colours named `COLOR_n` are linear, all others sRGB.
    #[default]
    Convert,
    /// The numbers stay as they are.
    Keep,
}

/// The axis that points up in the mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum UpAxis {
    /// As in glTF.
    #[default]
    Y,
    /// As in maps and in most programs for print and construction: glTF gets a node that turns it.
    Z,
}

/// How meshes are written in [`crate::io`]. What a format does not know is not for it.
///
/// ```no_run
/// use lwc::io::{ColorType, WriteOptions};
///
/// let file = lwc::io::read("model.glb")?;
/// let options = WriteOptions::new().color_type(ColorType::Ushort).split_seams(true);
/// let losses = options.write("model.ply", &file.mesh, &file.attributes)?;
/// println!("{losses}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct WriteOptions {
    /// PLY and OBJ: the type of positions. The others have float32.
    pub position_type: PositionType,
    /// The step of the grid that the positions are on, model units. Positions may move by an eighth of it
    /// ([`STEP_SHARE`]). `None`: not at all.
    pub step: Option<f64>,
    /// PLY: the type of colours.
    pub color_type: ColorType,
    /// All formats: whether colours are turned into the colour space of the format.
    pub color_space: ColorSpace,
    /// PLY and OBJ: repeat vertices at seams, so that each has one value of every attribute. glTF always does.
    pub split_seams: bool,
    /// glTF: which axis of the mesh points up.
    pub up: UpAxis,
}

/// The share of the step of the grid by which positions may move when they become float32.
pub const STEP_SHARE: f64 = 0.125;

impl WriteOptions {
    /// The defaults.
    pub fn new() -> Self {
        Self::default()
    }

    /// With this type of positions.
    #[must_use]
    pub fn position_type(self, position_type: PositionType) -> Self {
        Self { position_type, ..self }
    }

    /// With positions on a grid of this step, in model units.
    #[must_use]
    pub fn step(self, step: f64) -> Self {
        Self { step: Some(step), ..self }
    }

    /// With this type of colours.
    #[must_use]
    pub fn color_type(self, color_type: ColorType) -> Self {
        Self { color_type, ..self }
    }

    /// With colours in this space.
    #[must_use]
    pub fn color_space(self, color_space: ColorSpace) -> Self {
        Self { color_space, ..self }
    }

    /// With or without repeated vertices at seams.
    #[must_use]
    pub fn split_seams(self, split_seams: bool) -> Self {
        Self { split_seams, ..self }
    }

    /// With this axis pointing up.
    #[must_use]
    pub fn up(self, up: UpAxis) -> Self {
        Self { up, ..self }
    }

    /// Whether colours are to be linear, given what is usual in the format; `None` leaves them.
    pub(super) fn linear_colours(&self, usual: bool) -> Option<bool> {
        (self.color_space == ColorSpace::Convert).then_some(usual)
    }

    /// How far a position may move when it becomes float32, model units.
    pub(super) fn tolerance(&self) -> f64 {
        self.step.filter(|step| step.is_finite()).map_or(0.0, |step| STEP_SHARE * step.max(0.0))
    }
}
