use roverlab::geometry::{Point, Vector};
use roverlab::io::{Error, ErrorKind, Result as IoResult};
use roverlab::maze::files::{self, MazeFile};
use roverlab::maze::{Cell, Maze, Scale, mouse};
use roverlab::picture::{Picture, SERIES, Style};
use roverlab::world::{RobotSpec, Scene};

use crate::common::{CommonArgs, Failure};
use crate::driving::Run;

/// The commands' default maze: all walls are connected, and the goal is in a corner.
const OWN: &str = "\
o---o---o---o---o---o
|           |       |
o   o---o   o   o   o
|   |   |       |   |
o   o   o---o---o   o
|   |           | G |
o   o---o---o   o---o
|           |       |
o   o---o   o---o   o
| S |               |
o---o---o---o---o---o
";

/// A maze, and its robot.
#[derive(Debug, Clone)]
pub(super) struct Place {
    pub(super) file: MazeFile,
    pub(super) scale: Scale,
    pub(super) spec: RobotSpec,
}

impl Place {
    /// The maze of `--world`, or the default one, at the robot's scale.
    pub(super) fn new(common: &CommonArgs, small: bool) -> Result<Self, Failure> {
        common.check_maze()?;
        let file = match &common.world {
            Some(path) => {
                let bytes = common.read("world", path).map_err(Failure::input)?;
                files::parse(&bytes, &path.display().to_string())
            }
            None => files::parse(OWN.as_bytes(), "the command's own maze"),
        };
        let file = file.map_err(Failure::input)?;
        for defect in &file.defects {
            common.tell(format_args!("defect: {defect}"));
        }
        let (scale, spec) =
            if small { (Scale::MICROMOUSE, mouse()) } else { (Scale::DOUBLED, RobotSpec::s4()) };
        Ok(Self { file, scale, spec })
    }

    pub(super) fn maze(&self) -> &Maze {
        &self.file.maze
    }

    pub(super) fn scene(&self) -> Scene {
        let start = self.scale.pose(self.maze().start(), self.maze().heading());
        Scene::with_robot(self.scale.world(self.maze()), self.spec.clone(), start)
    }

    /// The cell at an offset east and north of the start; `None` outside the maze.
    pub(super) fn cell(&self, (east, north): (i32, i32)) -> Option<Cell> {
        let start = self.maze().start();
        let x = u16::try_from(i32::from(start.x) + east).ok()?;
        let y = u16::try_from(i32::from(start.y) + north).ok()?;
        Some(Cell::new(x, y)).filter(|&cell| self.maze().contains(cell))
    }

    /// The maze with its goal.
    pub(super) fn picture(&self, title: &str) -> Picture {
        let mut picture = Picture::new(&self.scale.world(self.maze()));
        let half = 0.5 * self.scale.cell;
        for goal in self.maze().goals() {
            let centre = self.scale.centre(goal);
            let corners = [(-half, -half), (half, -half), (half, half), (-half, half)];
            let style = Style::new(SERIES[2]).filled(0.25).width(0.5).labelled("goal");
            picture.polygon(corners.map(|(x, y)| centre + Vector::new(x, y)), style);
        }
        picture.title(title);
        picture
    }

    /// The same with the robot's path.
    pub(super) fn picture_of<T>(&self, title: &str, caption: String, run: &Run<T>) -> Picture {
        let mut picture = self.picture(title);
        picture.caption(caption);
        run.draw(&mut picture, &self.spec);
        picture
    }

    /// Whether a point lies in a goal cell.
    pub(super) fn is_at_goal(&self, point: Point) -> bool {
        self.scale.cell_of(self.maze(), point).is_some_and(|cell| self.maze().is_goal(cell))
    }
}

/// An unknown maze of the same size, with the same start and goal.
pub(super) fn unexplored(truth: &Maze) -> IoResult<Maze> {
    let known = Maze::unexplored(truth.width(), truth.height());
    let mut known = known.map_err(|error| Error::new(ErrorKind::InvalidInput, error.to_string()))?;
    known.set_start(truth.start(), truth.heading());
    known.set_goals(truth.goals());
    Ok(known)
}
