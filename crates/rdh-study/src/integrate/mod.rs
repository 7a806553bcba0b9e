//! Integrators: they make the rays of each mode, and pictures by the same paths.
//!
//! Whatever structure they cast through, the rays are the same bit for bit: hits don't depend on structures, and random
//! numbers belong to film positions. So the rays of a view are made once, and every structure casts the same batches.

mod ao;
mod caster;
mod cost;
mod film;
mod lens;
mod lidar;
mod mode;
mod parts;
mod path;
mod primary;
mod random;
mod shade;
mod stage;
mod stream;
mod vector;
mod whitted;

pub use cost::path_counts;
pub use lens::Lens;
pub use lidar::{LIDAR_AZIMUTHS, LIDAR_BEAMS, LIDAR_FIELD_DEGREES};
pub use mode::Mode;
pub(crate) use random::{Random, derived_seed};
pub use shade::radiance;
pub use stage::Stage;
pub use stream::{RayBatch, Shoot};
