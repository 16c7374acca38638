//! What may be typed after `lwc view`.

use crate::cli::args::{Reading, Scale};
use std::path::PathBuf;

/// Show a model in the browser, coarse at once and finer while it loads.
///
/// Serves a page on this machine, prints its address and opens it. A mesh (.obj .ply .stl .glb .gltf .las
/// .laz, or compressed, such as .obj.gz) is encoded first, with default options except those below.
#[derive(Debug, clap::Args)]
pub struct View {
    /// Stream (.lwc) or mesh to show.
    #[arg(value_name = "MODEL")]
    pub input: PathBuf,
    /// Port to listen on; 0 chooses one that is free.
    #[arg(long, value_name = "PORT", default_value_t = 0)]
    pub port: u16,
    /// Do not start a browser.
    #[arg(long)]
    pub no_open: bool,
    #[command(flatten)]
    pub reading: Reading,
    #[command(flatten)]
    pub scale: Scale,
}
