//! Benchmarks of roverlab; see `benches/`.
