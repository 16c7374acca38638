//! Multiresolution of a mesh: a base mesh and, per level, the details that prediction misses.
//!
//! The levels are those of Algorithm 1: M^L is the mesh, M^{k−1} has the even vertices of M^k. The details
//! of level k are what turns M^{k−1} into M^k, one vector per odd vertex v with the ring x_1 … x_d:
//!
//! - **Prediction.** With weights w_j ≥ 0, Σ w_j = 1, that put Σ w_j x_j where v lies along the surface
//!   (mean value coordinates of its projection, kept from the analysis), [`Prediction::Flat`] is
//!   c = Σ w_j x_j. [`Prediction::Curved`] follows the tangent planes at the x_j, with the vertex normals n_j
//!   of M^{k−1}: P = c + ½ Σ w_j ((x_j − c)·n_j) n_j, half way to Phong tessellation (Boubekeur and
//!   Alexa, 2008); on a sphere the half makes P right to second order.
//! - **Details** d = x_v − P are kept in a frame of the surface: z along Σ w_j n_j, x along the edge to the
//!   ring vertex that was farthest (from end to end of an open ring). So they turn with the surface when
//!   it is bent, and a rigid motion of M^{k−1} moves M^k rigidly.
//! - **Update** (off: the lazy wavelet of the paper). Every vertex of M^L has the mass 1, and an odd one
//!   leaves its mass to its ring: m'_e = m_e + Σ_o w_oe m_o. The even vertices take up
//!   x'_e = x_e + Σ_o u_oe d_o with u_oe = m_o m'_e / Σ_j m'_j², the smallest weights with
//!   Σ_e m'_e u_oe = m_o. With the flat prediction Σ m x is then the same on all levels:
//!   Σ_e m'_e x'_e = Σ_e m'_e x_e + Σ_o m_o d_o = Σ_e m_e x_e + Σ_o m_o (c_o + d_o). So M^{k−1} averages
//!   M^k in place of sampling it. An even vertex is
//!   in few rings, so this takes only some of its noise away.
//!   (Sweldens, *The lifting scheme*, 1996; the choice of weights as in Jansen and Oonincx, 2005.)
//!
//! Every step is undone exactly, up to the rounding of the arithmetic.
//!
//! ```
//! use lwc::multiresolution::{Decomposition, Options};
//!
//! # let positions = (0..400).map(|i| [f64::from(i % 20), f64::from(i / 20), f64::from(i * i % 7) * 0.1]);
//! # let cells = (0..380).filter(|i| i % 20 < 19);
//! # let triangles = cells.flat_map(|i| [[i, i + 1, i + 21], [i, i + 21, i + 20]]).collect();
//! # let mesh = lwc::TriMesh::new(positions.collect(), triangles)?;
//! let mut decomposition = Decomposition::new(&mesh, &Options::default())?;
//! let finest = decomposition.num_levels();
//! decomposition.scale_details(finest, 0.0);
//! let smoother = decomposition.reconstruct();
//! # assert_eq!(smoother.num_vertices(), mesh.num_vertices());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod decomposition;
mod denoise;
mod detail_transfer;
mod edit_error;
mod hierarchy;
mod lift;
mod options;
mod weights;

pub use decomposition::Decomposition;
pub use denoise::{Threshold, denoised, denoised_with_progress};
pub use detail_transfer::DetailTransfer;
pub use edit_error::EditError;
pub use options::{Options, Prediction};
