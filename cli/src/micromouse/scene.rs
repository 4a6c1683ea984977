use roverlab::maze::files::{self, MazeFile, MazeFormat};

use super::Args;
use crate::common::Failure;

/// The command's default maze: small, with a way round on either side and a staircase for diagonals.
const OWN: &str = "\
o---o---o---o---o---o---o---o---o
|               |               |
o   o---o---o   o   o---o---o   o
|   |       |       |       |   |
o   o   o   o---o---o   o   o   o
|   |   |               |   |   |
o   o   o---o   o---o---o   o   o
|   |       | G   G |       |   |
o   o---o   o   o   o   o---o   o
|       |   | G   G |   |       |
o---o   o   o---o   o   o   o---o
|       |           |           |
o   o---o---o---o---o---o---o   o
|   |       |       |       |   |
o   o   o---o   o---o   o---o   o
| S |       |       |           |
o---o---o---o---o---o---o---o---o
";

/// The maze of the options, or the default one.
pub(crate) fn maze(args: &Args) -> Result<MazeFile, Failure> {
    args.common.check_maze()?;
    let named = args.maze.as_ref().map(|file| ("maze", file));
    let file = match named.or(args.common.world.as_ref().map(|file| ("world", file))) {
        Some((option, file)) => {
            let bytes = args.common.read(option, file);
            bytes.and_then(|bytes| files::parse(&bytes, &file.display().to_string()))
        }
        None => files::parse(OWN.as_bytes(), "the command's own maze"),
    };
    file.map_err(Failure::input)
}

/// Name of a format in reports.
pub(crate) fn name(format: MazeFormat) -> &'static str {
    match format {
        MazeFormat::Text => "text",
        MazeFormat::Maze => "maze",
        MazeFormat::Map => "map",
        MazeFormat::Num => "num",
        MazeFormat::EyeSim => "eyesim",
        MazeFormat::Binary => "binary",
        _ => "other",
    }
}
