use std::num::NonZero;
use std::path::PathBuf;

use super::{Header, Part, PartFile, Portable};
use crate::common::{Failure, Origin, Outcome, Report, check_writable, share_out, threads};

/// The options of a campaign in parts, flattened into those of a command.
#[derive(Debug, Clone, Default, clap::Args)]
pub(crate) struct PartArgs {
    /// Do only part K of N of the campaign's runs, and write their results to the file of --out;
    /// `roverlab merge` makes the report of all parts.
    #[arg(long, value_name = "K/N", requires = "out")]
    pub(crate) part: Option<Part>,

    /// File for the results of --part.
    #[arg(long, value_name = "FILE", requires = "part")]
    pub(crate) out: Option<PathBuf>,

    /// Take the results from the files of all parts: `roverlab merge` gives this option.
    #[arg(long, value_name = "FILE", hide = true, conflicts_with = "part")]
    pub(crate) collected: Vec<PathBuf>,
}

/// Options of campaigns in parts, unsupported by other runs.
pub(crate) const OF_PARTS: &[&str] = &["part", "out", "collected"];

impl PartArgs {
    /// Results of all runs of a campaign, in order: of runs shared out to threads, or from the files of the
    /// parts. With `--part` it does and saves that part's runs, and fails with the report of that, by which
    /// the command ends. `things` names the runs in the progress line.
    pub(crate) fn share_out<T: Send + Portable>(
        &self,
        origin: &Origin,
        things: &str,
        runs: u64,
        crew: Option<NonZero<usize>>,
        work: impl Fn(u64) -> Result<T, Failure> + Sync,
    ) -> Result<Vec<T>, Failure> {
        let header = |part| Header::new(&origin.facts(), part, runs);
        if !self.collected.is_empty() {
            return PartFile::collect(&self.collected, &header(Part { number: 1, of: 1 })?);
        }
        let (Some(part), Some(out)) = (self.part, &self.out) else {
            return share_out(things, runs, threads(crew), work);
        };
        check_writable("--out", out)?;
        let file = PartFile { file: out, header: header(part)? };
        let results = share_out(things, part.runs(runs), threads(crew), |index| work(part.run(index)))?;
        file.write(&results)?;
        Err(Failure::done(
            Report { mixed_noise: true, ..Report::new(Outcome::verdict("part_done")) }
                .field("part", part.to_string())
                .field("runs", results.len())
                .field("out", out),
        ))
    }
}
