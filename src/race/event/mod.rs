//! Acceleration and skidpad: events whose layout is known in advance.
//!
//! The car knows the event and its rules, but neither its exact pose nor the exact placement of the cones. It
//! maps the cones that it sees ([`ConeMap`](super::ConeMap)), fits the edges of the layout to recently seen
//! cones ([`EventLayout`]) in every control period, and follows a line in the layout's frame with a
//! [`LineTracker`](super::LineTracker). Errors of odometry and map therefore do not accumulate.
//!
//! ```
//! use roverlab::geometry::{Point, Pose};
//! use roverlab::race::{
//!     CarLimits, CarOutline, Cone, ConeColour, ConeTrack, Event, EventCourse, EventParameters, EventPhase,
//!     EventRacer, EventReferee,
//! };
//! // An acceleration: two rows of cones, and gates of large ones 75 m apart.
//! let mut track = ConeTrack { start: Some(Pose::new(-2.45, 0.0, 0.0)), ..ConeTrack::default() };
//! for (side, colour) in [(1.5, ConeColour::Blue), (-1.5, ConeColour::Yellow)] {
//!     let gate = [-0.25, 0.25, 74.75, 75.25].map(|x| (x, ConeColour::BigOrange));
//!     let row = (1..15).map(|k| (5.0 * f64::from(k), colour));
//!     let lane = (1..21).map(|k| (75.0 + 5.0 * f64::from(k), ConeColour::Orange));
//!     for (x, colour) in gate.into_iter().chain(row).chain(lane) {
//!         track.cones.push(Cone::new(Point::new(x, side), colour));
//!     }
//! }
//! let outline = CarOutline { half_width: 0.7, nose: 2.15, ahead: 0.9, room: 0.0 };
//! let course = EventCourse::of(&track, &outline).expect("an event");
//! assert_eq!((course.event(), course.timed().len()), (Event::Acceleration, 1));
//! let best = course.optima(&CarLimits::circle(10.0, 5.0, 8.0, 30.0), &outline)[0];
//! assert!((best - 5.5).abs() < 0.5, "75 m at 5 m/s²: {best:.2} s");
//! // A car that has not seen anything stands and waits.
//! let racer = EventRacer::acceleration(EventParameters::default())?;
//! assert_eq!(racer.phase(), EventPhase::Looking);
//! // The referee observes a car that passes the gates at 10 m/s.
//! let wheels = [(0.0, 0.6), (0.0, -0.6), (1.55, 0.6), (1.55, -0.6)].map(|(x, y)| Point::new(x, y));
//! let mut referee = EventReferee::new(course, wheels, Point::new(2.15, 0.0));
//! for k in 0..900 {
//!     referee.see(f64::from(k) * 0.01, Pose::new(-2.45 + 0.1 * f64::from(k), 0.0, 0.0), 0);
//! }
//! assert!((referee.verdict().lap_times[0] - 7.5).abs() < 0.1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod course;
mod layout;
mod line;
mod racer;
mod referee;
#[cfg(test)]
mod tests;

pub use course::EventCourse;
pub use layout::{EventLayout, EventShape};
pub use racer::{EventParameters, EventPhase, EventRacer};
pub use referee::EventReferee;
