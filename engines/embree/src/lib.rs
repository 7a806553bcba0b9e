//! Embree 4 and Embree 3, loaded at run time, as competitors.
//!
//! ```text
//!  scene        a mesh in Embree, and rays cast through it
//!  packet       the same, sixteen rays at a time
//!  mode         what is built: high-avx2, medium-robust-avx512
//!  abi          where versions 3 and 4 differ
//!  library      the shared library: found, loaded, left loaded
//!  api          their C interface, as far as it is the same
//! ```

mod abi;
mod api;
mod library;
mod mode;
mod packet;
mod scene;

use std::process::ExitCode;

use scene::Scene;

/// The program of Embree 4.
pub fn serve_embree4() -> ExitCode {
    rdh_engine_protocol::serve::<Scene<abi::Four>>()
}

/// The program of Embree 3.
pub fn serve_embree3() -> ExitCode {
    rdh_engine_protocol::serve::<Scene<abi::Three>>()
}
