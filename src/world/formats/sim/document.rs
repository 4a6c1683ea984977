use super::super::error::{FormatError, Location};
use crate::geometry::Pose;
use crate::world::{Marker, Object, Scene, Settings};

/// A simulation script as written, before the files that it names are read.
#[derive(Debug, Clone, Default)]
pub struct SimFile {
    /// Its lines, without comments and blank lines.
    pub statements: Vec<Statement>,
    /// Location of the file name or placed thing of each statement; shorter for scripts that were not read
    /// from text.
    pub(super) places: Vec<Location>,
    /// Errors of lines with unknown words, in case the words become known.
    pub(super) broken: Vec<(usize, FormatError)>,
}

/// Equality ignores the locations.
impl PartialEq for SimFile {
    fn eq(&self, other: &Self) -> bool {
        self.statements == other.statements
    }
}

/// A line of a simulation script.
#[derive(Debug, Clone, PartialEq)]
pub enum Statement {
    /// `world`: file of the environment.
    World(String),
    /// `settings`.
    Settings(Settings),
    /// `robot`: file of a robot.
    Robot(String),
    /// `object`: file of an object.
    Object(String),
    /// A robot or object, placed by name.
    Place {
        /// Its name.
        name: String,
        /// Its start position.
        at: Position,
        /// Program of a robot, as written.
        program: Option<String>,
    },
    /// `marker`.
    Marker(Marker),
    /// A line that begins with an unknown word and is not a placement, as written, without its comment.
    Unknown(String),
}

/// Position of a placed thing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Position {
    /// At a pose.
    Pose {
        /// The pose.
        pose: Pose,
        /// Height above the floor, if given (m).
        elevation: Option<f64>,
    },
    /// At each occurrence of a letter in a maze.
    Letter {
        /// The letter, case-insensitive.
        letter: char,
        /// Heading (rad), if given.
        heading: Option<f64>,
    },
}

impl SimFile {
    /// The script of a scene whose world is in a file.
    ///
    /// Robots and objects that are not built in need `robot` and `object` lines, which the caller adds.
    pub fn for_scene(scene: &Scene, world: &str) -> Self {
        let pose = |pose, elevation| {
            let elevation = if elevation == 0.0 { None } else { Some(elevation) };
            Position::Pose { pose, elevation }
        };
        let mut statements = vec![Statement::World(world.into())];
        if scene.settings != Settings::default() {
            statements.push(Statement::Settings(scene.settings));
        }
        let object = |object: &Object| Statement::Place {
            name: object.kind.name.clone(),
            at: pose(object.pose, object.elevation),
            program: None,
        };
        let mut objects = scene.world.objects.iter().enumerate().peekable();
        for robot in &scene.robots {
            while let Some((_, before)) = objects.next_if(|(index, _)| *index < robot.objects_before) {
                statements.push(object(before));
            }
            statements.push(Statement::Place {
                name: robot.spec.name.clone(),
                at: pose(robot.pose, robot.elevation),
                program: robot.program.clone(),
            });
        }
        statements.extend(objects.map(|(_, behind)| object(behind)));
        statements.extend(scene.world.markers.iter().copied().map(Statement::Marker));
        Self { statements, ..Self::default() }
    }

    pub(super) fn push(&mut self, statement: Statement, at: Location) {
        self.statements.push(statement);
        self.places.push(at);
    }

    pub(super) fn location(&self, index: usize) -> Location {
        self.places.get(index).copied().unwrap_or(Location { line: index + 1, column: 1 })
    }
}
