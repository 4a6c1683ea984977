//! Navigation to a goal in a known world that may have changed.

mod chart;
mod destination;
mod locator;
mod navigator;
mod parameters;
mod report;
mod route;
mod steering;
mod sweep;
#[cfg(test)]
mod tests;

pub use navigator::Navigator;
pub use parameters::NavigatorParameters;
pub use report::{NavigatorEvent, NavigatorOutcome, NavigatorPhase};
