//! Racing between cones (book, section 14.5).
//!
//! - [`parse_track`]: reads tracks of FSSIM, EUFS and the TUM racetrack database; [`write_fssim`],
//!   [`write_eufs`] and [`write_tum`] write them; [`parse_cone_log`] reads logs of a car's known cones, in
//!   which a [`LaneFinder`] finds the lane;
//! - [`generate`]: tracks by the rules of Formula Student, from a seed;
//! - [`CentreLine`]: the track between cones, by a triangulation, with or without colours;
//! - [`GapDriver`]: the book's driver, which steers for the nearest gap in one scan;
//! - [`Racer`]: detects cones in scans ([`sightings`]), maps them in the first lap ([`ConeMap`]), then races;
//!   a [`LineTracker`] keeps the car on its line; a [`Referee`] takes times and counts penalties; a
//!   [`PlaceReferee`] judges several cars that race for places;
//! - [`EventRacer`]: drives an acceleration or a skidpad, whose layouts are known; an [`EventReferee`] takes
//!   the times;
//! - [`minimum_curvature`]: the racing line within a [`Corridor`]; [`SpeedProfile`]: the speeds along it,
//!   within the [`GripLimit`].

mod arcs;
mod banded;
mod beam_search;
mod box_qp;
mod camera_sight;
mod centre_line;
mod cone;
mod corridor;
mod curve;
mod error;
mod event;
mod files;
mod finder;
mod fit;
mod gap;
mod generate;
mod grip;
mod landmark;
mod lane;
mod lane_model;
mod lap;
mod legs;
mod map;
mod mesh;
mod pair;
mod passing;
mod places;
mod profile;
mod racer;
#[cfg(test)]
mod racer_tests;
mod racing_line;
mod reckoning;
mod referee;
mod registration;
mod round;
mod rows;
mod run;
mod sides;
mod sight;
mod spline;
#[cfg(test)]
mod tests;
mod tracker;
mod tyres;
mod view;
mod ways;

pub use camera_sight::{CameraMount, CameraSight};
pub use centre_line::CentreLine;
pub use cone::{Cone, ConeColour, ConeTrack, Event};
pub use corridor::{Corridor, CrossSection};
pub use error::LineError;
pub use event::{
    EventCourse, EventLayout, EventParameters, EventPhase, EventRacer, EventReferee, EventShape,
};
pub use files::{
    ConeFrame, TrackFile, parse_cone_log, parse_eufs, parse_fssim, parse_line, parse_track, parse_tum,
    write_eufs, write_fssim, write_tum,
};
pub use finder::LaneFinder;
pub use gap::{GapCommand, GapDriver};
pub use generate::{GeneratedTrack, TrackOptions, generate, lined};
pub use grip::GripLimit;
pub use lane::lane;
pub use lane_model::{Lane, LaneParameters};
pub use map::{ConeMap, ConeMapParameters};
pub use pair::CentreLineParameters;
pub use places::{Overtaking, PlaceReferee};
pub use profile::{CarLimits, SpeedProfile};
pub use racer::{RacePhase, Racer, RacerParameters};
pub use racing_line::{CarOutline, LineSolver, RacingLine, RacingLineParameters, minimum_curvature};
pub use referee::{RaceScore, Referee};
pub use run::{RaceObservation, RaceOutcome};
pub use sight::{ConeSighting, sightings};
pub use spline::{ClosedSpline, SplinePoint};
pub use tracker::{LineTracker, LineTrackerParameters};
pub use tyres::Tyres;
