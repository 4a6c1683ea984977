//! The planners of `roverlab::nav::grid` beside their peers: the same queries, costs compared first, then
//! times.
//!
//! `cargo bench -p roverlab-bench --bench planners` prints a table for each map with the median time of a
//! query and, at the end, geometric means of the ratios over the maps of 512 cells and more. Published maps
//! take part where the environment variable `ROVERLAB_DATA` names the folder that holds `movingai/`; others
//! are made here. `-- --scaling` shows how the planners and the decomposition into a quadtree grow up to 4096
//! x 4096 cells instead, with fewer queries on larger maps. `--queries N` and `--repeat N` say how many
//! queries a map has got and how often each is asked, the fastest time of which counts; `--maps TEXT` takes
//! the maps alone whose names hold a text, `--own` none but those made here.

#[path = "planners/compare.rs"]
mod compare;
#[path = "planners/decomposition.rs"]
mod decomposition;
#[path = "planners/mesh.rs"]
mod mesh;
#[path = "planners/peers.rs"]
mod peers;
#[path = "planners/summary.rs"]
mod summary;
#[path = "planners/table.rs"]
mod table;

use std::process::ExitCode;

use roverlab_bench::maps;

/// What the command line asks for.
#[derive(Debug)]
struct Options {
    queries: usize,
    repeat: usize,
    maps: String,
    own: bool,
    scaling: bool,
}

impl Options {
    fn read() -> Result<Self, String> {
        let mut options = Self { queries: 200, repeat: 3, maps: String::new(), own: false, scaling: false };
        let mut words = std::env::args().skip(1);
        while let Some(word) = words.next() {
            let mut value = || words.next().ok_or(format!("{word}: expected a value after it"));
            match word.as_str() {
                "--queries" => options.queries = number(&value()?)?,
                "--repeat" => options.repeat = number(&value()?)?,
                "--maps" => options.maps = value()?,
                "--own" => options.own = true,
                "--scaling" => options.scaling = true,
                // What cargo itself adds.
                "--bench" => {}
                other => {
                    return Err(format!(
                        "found {other}; expected --queries N, --repeat N, --maps TEXT, --own or --scaling"
                    ));
                }
            }
        }
        Ok(options)
    }
}

fn number(word: &str) -> Result<usize, String> {
    let number = word.parse().ok().filter(|&number| number > 0);
    number.ok_or(format!("found {word}; expected a whole number above 0"))
}

fn main() -> ExitCode {
    let options = match Options::read() {
        Ok(options) => options,
        Err(message) => {
            eprintln!("{message}");
            return ExitCode::from(2);
        }
    };
    if options.scaling {
        scaling(&options);
        return ExitCode::SUCCESS;
    }
    let mut maps = maps::own(512, options.queries);
    maps.extend(maps::own(1024, options.queries).into_iter().filter(|map| map.name.starts_with("cave")));
    if !options.own {
        maps.extend(maps::published(options.queries));
    }
    maps.retain(|map| map.name.contains(&options.maps));
    let mut results = Vec::new();
    for map in maps {
        let result = compare::compare(&map, &table::ALL, options.repeat);
        print!("{result}");
        results.push(result);
    }
    print!("{}", summary::summary(&results));
    decomposition::show(1024);
    ExitCode::SUCCESS
}

/// Cells along the sides of maps, and how many queries these get at most: a search of all cells of the last
/// takes seconds.
const SIZES: [(usize, usize); 5] = [(256, 100), (512, 100), (1024, 50), (2048, 20), (4096, 8)];

/// How the planners of this library grow.
fn scaling(options: &Options) {
    let mut results = Vec::new();
    for (size, queries) in SIZES {
        for map in maps::own(size, options.queries.min(queries)) {
            if map.name.contains(&options.maps) {
                let result = compare::compare(&map, &table::ours(), options.repeat);
                print!("{result}");
                results.push(result);
            }
        }
        decomposition::show(size);
    }
    print!("{}", summary::growth(&results));
}
