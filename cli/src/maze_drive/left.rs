use roverlab::io::control::{self, until};
use roverlab::io::sim::NoiseModel;
use roverlab::maze::{CellDriveParameters, LeftHand, LeftHandOutcome, LeftHandParameters, Rig, Straight};

use super::place::Place;
use crate::common::{CommonArgs, Failure, Outcome, Report, millimetres};
use crate::driving::{Conditions, paced};

/// Method of driving from cell to cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Drive {
    /// By odometry alone, like the book's first program.
    Open,
    /// Centred between the walls by a proportional controller, like the book's second program; it oscillates.
    P,
    /// Centred by a PID controller, with odometry to reduce the noise of the readings.
    Pid,
}

/// Command line of `maze-left`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Follows the left wall of a maze until the goal or the start is reached",
    after_help = "\
--world accepts a maze in any format (EyeSim's .maz, the micromouse text format, .maze, map, num), including the start.
Cells are 360 mm wide for an S4, as in the book, or 180 mm with --micromouse.

JSON fields:
  drive                       open, p or pid
  width, height               cells
  cells                       driven cells, by the robot's count
  at_goal, back               whether the robot estimates to be in the goal, or back at the start
  really                      whether it is truly there
  off_middle_mm               distance from the middle of the estimated cell
  picture                     always
Outcomes: goal, returned, lost (the estimated cell is wrong), stuck, enclosed (walls on all sides), timed_out, collided,
failed."
)]
pub(crate) struct LeftArgs {
    /// Method of driving from cell to cell.
    #[arg(long, value_enum, default_value_t = Drive::Pid)]
    pub(crate) drive: Drive,

    /// Use a micromouse in a maze of competition size.
    #[arg(long)]
    pub(crate) micromouse: bool,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(LeftArgs, common: CommonArgs);

/// Driving parameters in a maze.
fn parameters(
    args: &LeftArgs,
    place: &Place,
    conditions: &Conditions,
) -> Result<LeftHandParameters, Failure> {
    let range = NoiseModel::real().scaled(conditions.noise).range;
    let rig = Rig::new(&place.spec, conditions.odometry_errors(), range).map_err(Failure::input)?;
    let speed = 0.5 * place.scale.cell;
    Ok(match args.drive {
        Drive::Open => {
            let straight = Straight::OpenLoop { length: place.scale.cell, speed };
            let threshold = place.scale.cell / 0.9;
            LeftHandParameters { straight, threshold, ..LeftHandParameters::as_printed() }
        }
        Drive::P => {
            LeftHandParameters::controlled(CellDriveParameters::proportional(&rig, place.scale, speed))
        }
        Drive::Pid => LeftHandParameters::controlled(CellDriveParameters::pid(&rig, place.scale, speed)),
    })
}

/// The command's work.
pub(crate) fn work(args: &LeftArgs) -> Result<Report, Failure> {
    args.common.check_picture()?;
    let place = Place::new(&args.common, args.micromouse)?;
    let maze = place.maze();
    let conditions = Conditions::new(&args.common, 60.0 + 12.0 * maze.cell_count() as f64)?;
    let parameters = parameters(args, &place, &conditions)?;
    let mut rule = LeftHand::new(parameters, maze.heading()).map_err(Failure::input)?;
    let (mut cells, mut at) = (0_usize, Some(maze.start()));
    let run = conditions.run(&place.scene(), paced(&args.common), |robot, step| {
        control::run(robot, &mut rule, conditions.time_limit, |_, rule, _| {
            step();
            let arrived = rule.cells() > cells;
            (cells, at) = (rule.cells(), place.cell(rule.at()));
            until(arrived && at.is_none_or(|cell| maze.is_goal(cell) || cell == maze.start()))
        })
    })?;
    let end = run.truth.pose.position();
    let really = at.is_some() && place.scale.cell_of(maze, end) == at;
    let at_goal = at.is_some_and(|cell| maze.is_goal(cell));
    let off = at.map(|cell| (place.scale.centre(cell) - end).norm());
    let report = run.report(|&outcome| match outcome {
        LeftHandOutcome::Stalled => Outcome::failure("stuck"),
        LeftHandOutcome::Enclosed => Outcome::failure("enclosed"),
        LeftHandOutcome::Stopped if !really => Outcome::failure("lost"),
        LeftHandOutcome::Stopped => Outcome::verdict(if at_goal { "goal" } else { "returned" }),
        _ => Outcome::failure("timed_out"),
    });
    let drive = match args.drive {
        Drive::Open => "open",
        Drive::P => "p",
        Drive::Pid => "pid",
    };
    let report = report
        .field("drive", drive)
        .field("width", maze.width())
        .field("height", maze.height())
        .field("cells", cells)
        .field("at_goal", at_goal)
        .field("back", at == Some(maze.start()))
        .field("really", really)
        .field("off_middle_mm", off.map(millimetres));
    Ok(args.common.draw(report, "maze_left.svg", || {
        place.picture_of("Left hand on the wall", format!("{cells} cells"), &run)
    }))
}
