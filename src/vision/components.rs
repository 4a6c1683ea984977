use super::GrayView;

/// A connected group of pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blob {
    /// Number of pixels.
    pub area: usize,
    /// Upper left pixel (column, row) of the bounding box.
    pub min: (usize, usize),
    /// Lower right pixel (column, row) of the bounding box.
    pub max: (usize, usize),
    /// Mean column and row of the pixels.
    pub centroid: (f64, f64),
}

/// Finds 8-connected groups of pixels that are not 0. Its buffers are reused from image to image.
///
/// Union-find joins runs of pixels to those of the row above: linear in the number of pixels.
///
/// ```
/// use roverlab::vision::{Components, GrayView};
/// let mask = [
///     1, 1, 0, 0, 0, //
///     0, 0, 1, 0, 1, //
///     0, 0, 0, 0, 1,
/// ];
/// let mut components = Components::new();
/// let areas = components.find(GrayView::new(&mask, 5, 3)?, 1).iter().map(|blob| blob.area);
/// assert_eq!(areas.collect::<Vec<_>>(), [3, 2], "diagonal neighbours are connected");
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Components {
    runs: Vec<Run>,
    /// For each run, a connected run with an index at most its own; the root of a group points to itself.
    parents: Vec<usize>,
    groups: Vec<Group>,
    blobs: Vec<Blob>,
}

/// A run of adjacent pixels in a row.
#[derive(Debug, Clone, Copy)]
struct Run {
    y: usize,
    from: usize,
    /// One past the last column.
    to: usize,
}

/// Accumulated data of a group.
#[derive(Debug, Clone, Copy)]
struct Group {
    root: usize,
    area: usize,
    min: (usize, usize),
    max: (usize, usize),
    sum: (u64, u64),
}

impl Components {
    /// A finder without buffers; the first image allocates them.
    pub fn new() -> Self {
        Self::default()
    }

    /// Groups of at least `min_area` pixels, ordered by their first pixel, row by row.
    pub fn find(&mut self, mask: GrayView<'_>, min_area: usize) -> &[Blob] {
        self.runs.clear();
        self.parents.clear();
        let mut above = 0..0;
        for y in 0..mask.height() {
            let start = self.runs.len();
            self.add_runs(mask.row(y), y);
            self.join(above, start);
            above = start..self.runs.len();
        }
        self.add_up();
        self.blobs.clear();
        self.blobs.extend(self.groups.iter().filter(|group| group.area >= min_area).map(Group::blob));
        &self.blobs
    }

    /// The largest group, the first one if several are equal; `None` if no group has `min_area` pixels.
    pub fn largest(&mut self, mask: GrayView<'_>, min_area: usize) -> Option<Blob> {
        let blobs = self.find(mask, min_area);
        let most = blobs.iter().map(|blob| blob.area).max()?;
        blobs.iter().find(|blob| blob.area == most).copied()
    }

    fn add_runs(&mut self, row: &[u8], y: usize) {
        let mut x = 0;
        while let Some(skipped) = row[x..].iter().position(|&pixel| pixel != 0) {
            let from = x + skipped;
            let to =
                row[from..].iter().position(|&pixel| pixel == 0).map_or(row.len(), |length| from + length);
            self.parents.push(self.runs.len());
            self.runs.push(Run { y, from, to });
            x = to;
        }
    }

    /// Joins the runs from `start` on to those of the row above.
    fn join(&mut self, above: std::ops::Range<usize>, start: usize) {
        let mut first = above.start;
        for run in start..self.runs.len() {
            let Run { from, to, .. } = self.runs[run];
            while first < above.end && self.runs[first].to < from {
                first += 1;
            }
            let mut other = first;
            while other < above.end && self.runs[other].from <= to {
                self.unite(run, other);
                other += 1;
            }
        }
    }

    fn unite(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.parents[a.max(b)] = a.min(b);
    }

    fn root(&mut self, mut run: usize) -> usize {
        while self.parents[run] != run {
            self.parents[run] = self.parents[self.parents[run]];
            run = self.parents[run];
        }
        run
    }

    /// Accumulates the runs of each group. The root precedes the other runs of its group.
    fn add_up(&mut self) {
        self.groups.clear();
        for index in 0..self.runs.len() {
            let root = self.root(index);
            let run = self.runs[index];
            let known = self.groups.binary_search_by_key(&root, |group| group.root);
            match known {
                Ok(place) => self.groups[place].add(run),
                Err(_) => self.groups.push(Group::new(root, run)),
            }
        }
    }
}

impl Group {
    fn new(root: usize, run: Run) -> Self {
        let (min, max) = ((run.from, run.y), (run.to - 1, run.y));
        let mut group = Self { root, area: 0, min, max, sum: (0, 0) };
        group.add(run);
        group
    }

    fn add(&mut self, Run { y, from, to }: Run) {
        let length = to - from;
        self.area += length;
        self.min = (self.min.0.min(from), self.min.1);
        self.max = (self.max.0.max(to - 1), y);
        // Sum of the columns: their number times the mean of the first and the last.
        self.sum.0 += (length * (from + to - 1) / 2) as u64;
        self.sum.1 += (length * y) as u64;
    }

    fn blob(&self) -> Blob {
        let area = self.area as f64;
        let centroid = (self.sum.0 as f64 / area, self.sum.1 as f64 / area);
        Blob { area: self.area, min: self.min, max: self.max, centroid }
    }
}
