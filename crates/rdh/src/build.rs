//! From a spec to a structure.

use crate::accel::{self, Accel};
use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::options::BuildOptions;
use crate::rays::Training;
use crate::spec::Spec;
use crate::tune;

/// Builds what `spec` names, from `rays` where its heuristic asks for them. For `auto` it chooses by the rays, with counts alone
/// ([`tune::auto`]); [`Stats::spec`](crate::Stats::spec) says what.
///
/// # Errors
/// A heuristic that needs rays, or `auto`, without any; a budget that can't be kept, lack of memory, or cancellation.
pub fn build(mesh: &Mesh, spec: &Spec, rays: &Training, options: &BuildOptions<'_>) -> Result<Accel> {
    if *spec != Spec::AUTO {
        return accel::build(mesh, spec, rays, options);
    }
    if rays.is_empty() {
        return Err(Error::NoRays { spec: spec.to_string() });
    }
    Ok(tune::auto(mesh, rays, options)?.accel)
}
