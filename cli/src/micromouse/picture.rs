use roverlab::geometry::{Point, Pose, Vector};
use roverlab::io::sim::TICK;
use roverlab::maze::files::MazeFile;
use roverlab::maze::{Cell, Maze, Route, Scale};
use roverlab::picture::{Mark, Picture, SERIES, Style};

/// The maze with start and goal.
pub(crate) fn of_maze(maze: &Maze, scale: Scale) -> Picture {
    let mut picture = Picture::new(&scale.world(maze));
    let half = 0.5 * scale.cell;
    for goal in maze.goals() {
        let centre = scale.centre(goal);
        let corners = [(-half, -half), (half, -half), (half, half), (-half, half)];
        let style = Style::new(SERIES[2]).filled(0.25).width(0.5).labelled("goal");
        picture.polygon(corners.map(|(x, y)| centre + Vector::new(x, y)), style);
    }
    picture.mark(Mark::Start, scale.centre(maze.start()));
    picture
}

/// The routes with the fewest steps and with the fewest turns.
pub(crate) fn of_plan(file: &MazeFile, short: Option<&Route>, straight: Option<&Route>) -> Picture {
    let scale = Scale::MICROMOUSE;
    let mut picture = of_maze(&file.maze, scale);
    let caption = match (short, straight) {
        (Some(short), Some(straight)) => format!(
            "shortest route: {} steps, {} turns; fewest turns: {} in {} steps",
            short.steps(),
            short.turns(),
            straight.turns(),
            straight.steps()
        ),
        _ => "no way to the goal".into(),
    };
    picture.title("Micromouse").caption(caption);
    let shift = 0.06 * scale.cell;
    if let Some(straight) = straight {
        let style = Style::new(SERIES[1]).width(2.0).labelled("fewest turns");
        picture.line(points(straight, scale, shift), style);
    }
    if let Some(short) = short {
        picture.line(points(short, scale, -shift), Style::new(SERIES[0]).width(2.6).labelled("fewest steps"));
    }
    picture
}

/// Centres of a route's cells, shifted to tell two routes apart.
fn points(route: &Route, scale: Scale, shift: f64) -> Vec<Point> {
    route.cells().map(|cell: Cell| scale.centre(cell) + Vector::new(shift, shift)).collect()
}

/// The robot's path: pale during exploration, coloured by speed on the fast run.
pub(crate) fn add_drive(picture: &mut Picture, trail: &[(f64, Pose)], split: usize) {
    let style = Style::new(SERIES[1]).width(1.6).opacity(0.6).labelled("exploration");
    picture.trace(trail[..split].iter().map(|(time, pose)| (*time, pose.position())), style);
    let fast = trail[split.saturating_sub(1)..].windows(2);
    picture.speed_trace(fast.map(|pair| {
        let [(before, from), (time, to)] = [pair[0], pair[1]];
        (time, to.position(), from.distance_to(to.position()) / (time - before).max(TICK))
    }));
}
