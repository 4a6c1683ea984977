use roverlab::geometry::units;
use roverlab::nav::BugOutcome;
use roverlab::picture::{Mark, Picture, Style};
use roverlab::world::Colour;

use super::{Drive, Ending, Options};
use crate::common::Trip;

/// A picture of a run: the world, where the robot was and believed to be, and what it met and saw.
pub(crate) fn of(trip: &Trip, drive: &Drive, options: &Options) -> Picture {
    let spec = trip.spec();
    let mut picture = Picture::new(&trip.scene.world);
    picture.title(title(drive)).caption(caption(drive, options));
    picture.points(drive.seen.iter().copied(), Style::lidar());
    picture.true_path(drive.true_path.iter().copied());
    picture.odometry_path(drive.odometry_path.iter().copied());
    for other in &trip.scene.robots[1..] {
        picture.robot_with(other.pose, &other.spec.footprint, Style::new(Colour::from_hex(0x8a_90_9c)));
    }
    picture.robot(drive.truth.pose, &spec.footprint);
    picture.mark(Mark::Start, trip.start().position());
    picture.mark(Mark::Goal, trip.goal);
    for (number, point) in (1..).zip(drive.hit_points()) {
        picture.mark_named(Mark::HitPoint, point, format!("H{number}"));
    }
    for (number, point) in (1..).zip(drive.leave_points()) {
        picture.mark_named(Mark::LeavePoint, point, format!("L{number}"));
    }
    for &point in &drive.truth.contact_places {
        picture.mark(Mark::Contact, point);
    }
    picture
}

fn title(drive: &Drive) -> String {
    let ending = match &drive.ending {
        Ending::Verdict(BugOutcome::Reached) => "goal reached",
        Ending::Verdict(BugOutcome::Unreachable) => "the goal cannot be reached",
        Ending::Verdict(BugOutcome::TimedOut | BugOutcome::Stopped) => "the time is over",
        Ending::Failed(_) => "the robot failed",
    };
    let contacts = match drive.truth.contacts {
        0 => String::new(),
        1 => ", with a contact".into(),
        n => format!(", with {n} contacts"),
    };
    format!("DistBug: {ending}{contacts}")
}

fn caption(drive: &Drive, options: &Options) -> String {
    let (metres, seconds) = (drive.truth.path_length, drive.sim_time);
    let off = units::to_mm(drive.goal_distance);
    let (noise, seed) = (options.noise, options.seed);
    format!("{metres:.1} m in {seconds:.0} s, {off:.0} mm from the goal, noise {noise}, seed {seed}")
}
