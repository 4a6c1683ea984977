use roverlab::geometry::Point;
use roverlab::picture::{Mark, Picture, SERIES, Style};

use super::contest::Setting;
use super::ride::{Conditions, Ride};

/// One panel per algorithm, with the world and the path.
pub(super) fn of(setting: &Setting, rides: &[Ride], conditions: Conditions) -> Picture {
    let trip = &setting.trip;
    let panel = |(index, ride): (usize, &Ride)| {
        let mut panel = Picture::new(&trip.scene.world);
        let style = Style::new(SERIES[index % SERIES.len()]).width(2.0);
        panel.title(label(ride)).mark(Mark::Start, trip.start().position()).mark(Mark::Goal, trip.goal);
        panel.trace(timed(ride), style);
        panel
    };
    let panels: Vec<Picture> = rides.iter().enumerate().map(panel).collect();
    let mut picture = Picture::panels(&panels, 4);
    let none =
        if setting.reachable == Some(false) { "no way to the goal" } else { "a way to beside the goal" };
    let way = setting.shortest.map_or(none.into(), |way| format!("shortest way {way:.1} m"));
    picture
        .title(format!("The bug family: {}", setting.family))
        .caption(format!("{way}, noise {}, seed {}", conditions.noise, conditions.seed));
    picture
}

/// The path with times, as all steps take equally long.
fn timed(ride: &Ride) -> impl Iterator<Item = (f64, Point)> {
    let step = ride.sim_time / ride.path.len().saturating_sub(1).max(1) as f64;
    (0_u32..).zip(&ride.path).map(move |(index, point)| (f64::from(index) * step, *point))
}

fn label(ride: &Ride) -> String {
    let (name, metres) = (ride.kind.name(), ride.path_length);
    match ride.word() {
        "reached" => format!("{name}: {metres:.1} m"),
        word => format!("{name}: {}", word.replace('_', " ")),
    }
}
