//! Any-angle paths.

mod field;
mod lazy_theta;
mod scan;
mod search;
mod sight;
#[cfg(test)]
mod tests;

pub(super) use field::{Field, HalfPoint};
pub use lazy_theta::LazyThetaStar;
pub use search::AnyAngle;
pub(super) use sight::in_sight;
