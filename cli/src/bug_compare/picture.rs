use std::f64::consts::TAU;

use roverlab::geometry::{Point, direction};
use roverlab::picture::{Mark, Picture, Style, ramp};

use super::contest::Setting;
use super::ride::{Conditions, Ending, Ride};

/// Metres that paths are moved aside by, so that those along the same wall do not hide each other.
const ASIDE: f64 = 0.012;

/// A picture of one world with the paths of all algorithms.
pub(super) fn of(setting: &Setting, rides: &[Ride], conditions: Conditions) -> Picture {
    let trip = &setting.trip;
    let mut picture = Picture::new(&trip.scene.world);
    let way = setting.shortest.map_or("no way to the goal".into(), |way| format!("shortest way {way:.1} m"));
    picture.title(format!("The bug family: {}", setting.family)).caption(format!(
        "{way}, noise {}, seed {}; lines are moved aside by up to {:.0} mm",
        conditions.noise,
        conditions.seed,
        1e3 * ASIDE
    ));
    for (index, ride) in rides.iter().enumerate() {
        let share = index as f64 / rides.len() as f64;
        let aside = direction(TAU * share) * ASIDE;
        let style = Style::new(ramp(share)).width(1.6).labelled(label(ride));
        picture.line(ride.path.iter().map(|point: &Point| point + aside), style);
    }
    picture.robot(trip.start(), &trip.spec().footprint);
    picture.mark(Mark::Start, trip.start().position());
    picture.mark(Mark::Goal, trip.goal);
    picture
}

fn label(ride: &Ride) -> String {
    let (name, metres) = (ride.kind.name(), ride.path_length);
    match &ride.ending {
        Ending::Verdict(_) => format!("{name}: {}, {metres:.1} m", ride.ending.word().replace('_', " ")),
        Ending::Failed(_) => format!("{name}: the robot failed"),
    }
}
