//! Integrators, measurement and statistics.
