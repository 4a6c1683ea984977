use roverlab::geometry::units;
use roverlab::nav::BugOutcome;
use roverlab::picture::{Mark, Picture, Style};

use super::{Drive, Happening, Options};
use crate::common::Trip;
use crate::driving::pale;

/// Picture of a run: the world, true and estimated path, and what the robot met and saw.
pub(crate) fn of(trip: &Trip, drive: &Drive, options: &Options) -> Picture {
    let spec = trip.spec();
    let mut picture = Picture::new(&trip.scene.world);
    picture.title(title(drive, options.noise)).caption(caption(drive, options));
    picture.during(drive.sim_time..).points(drive.seen.iter().copied(), Style::lidar()).during(..);
    for other in &trip.scene.robots[1..] {
        picture.robot_with(other.pose, &other.spec.footprint, pale());
    }
    picture.drive(&drive.trail, &spec.footprint);
    picture.trace(drive.odometry_path.iter().copied(), Style::odometry());
    picture.mark(Mark::Start, trip.start().position());
    picture.mark(Mark::Goal, trip.goal);
    let (mut hits, mut leaves) = (0, 0);
    for event in &drive.events {
        picture.during(event.time..);
        match event.happening {
            Happening::Hit { point, .. } => {
                hits += 1;
                picture.mark_named(Mark::HitPoint, point, format!("H{hits}"))
            }
            Happening::Leave { point, .. } => {
                leaves += 1;
                picture.mark_named(Mark::LeavePoint, point, format!("L{leaves}"))
            }
            Happening::Contact { point } => picture.mark(Mark::Contact, point),
        };
    }
    picture
}

fn title(drive: &Drive, noise: f64) -> String {
    let ending = match &drive.ending {
        _ if drive.is_missed(noise) => "goal missed",
        Ok(BugOutcome::Reached) => "goal reached",
        Ok(BugOutcome::Unreachable) => "the goal cannot be reached",
        Ok(BugOutcome::NoRoom) => "no room at the goal",
        Ok(BugOutcome::TimedOut | BugOutcome::Stopped) => "the time is over",
        Err(_) => "the robot failed",
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
