use roverlab::vision::signs::SignFinder;
use serde_json::json;

use super::Marked;
use crate::common::{Failure, Outcome, Report, Stopwatch, rounded};

/// Intersection over union from which a find is the sign of a box.
const SAME: f64 = 0.5;

/// What was right and wrong in pictures with known signs.
#[derive(Debug)]
pub(super) struct Evaluation {
    names: Vec<String>,
    finds: bool,
    pictures: usize,
    /// Of each class: signs that were found, finds that are none, signs that were not found.
    counts: Vec<[usize; 3]>,
    /// Time for each picture (ms).
    times: Vec<f64>,
}

impl Evaluation {
    fn new(finder: &SignFinder, finds: bool) -> Self {
        let names = finder.model().names().to_vec();
        Self { counts: vec![[0; 3]; names.len()], names, finds, pictures: 0, times: Vec::new() }
    }

    /// Searches for signs. Those with a side of less than `least` pixels may be found or not.
    pub(super) fn by_search(
        finder: &mut SignFinder,
        pictures: &[Marked],
        least: f64,
    ) -> Result<Self, Failure> {
        let mut evaluation = Self::new(finder, true);
        for picture in pictures {
            let watch = Stopwatch::start();
            let found = finder.find(picture.view()).map_err(Failure::run)?;
            evaluation.end_picture(&watch);
            let mut is_taken = vec![false; picture.signs.len()];
            for find in found {
                let is_it = |(sign, &is_taken): (&(usize, _), &bool)| {
                    !is_taken && sign.0 == find.class && find.area.overlap(&sign.1) >= SAME
                };
                let place = picture.signs.iter().zip(&is_taken).position(is_it);
                if let Some(place) = place {
                    is_taken[place] = true;
                } else {
                    evaluation.counts[find.class][1] += 1;
                }
            }
            for ((class, area), is_found) in picture.signs.iter().zip(is_taken) {
                if area.width.min(area.height) >= least {
                    evaluation.counts[*class][if is_found { 0 } else { 2 }] += 1;
                }
            }
        }
        Ok(evaluation)
    }

    /// Tells the classes of boxes.
    pub(super) fn by_boxes(finder: &mut SignFinder, pictures: &[Marked]) -> Result<Self, Failure> {
        let mut evaluation = Self::new(finder, false);
        for picture in pictures {
            let watch = Stopwatch::start();
            for (class, area) in &picture.signs {
                let (told, _) = finder.classify(picture.view(), *area).map_err(Failure::run)?;
                if told == *class {
                    evaluation.counts[*class][0] += 1;
                } else {
                    evaluation.counts[told][1] += 1;
                    evaluation.counts[*class][2] += 1;
                }
            }
            evaluation.end_picture(&watch);
        }
        Ok(evaluation)
    }

    fn end_picture(&mut self, watch: &Stopwatch) {
        self.pictures += 1;
        self.times.push(1000.0 * watch.seconds());
    }

    /// Name, precision, recall, F1 and counts of each class that occurs.
    pub(super) fn classes(&self) -> impl Iterator<Item = (&str, [f64; 3], [usize; 3])> {
        let share = |part: usize, whole: usize| if whole == 0 { 0.0 } else { part as f64 / whole as f64 };
        let occurring =
            self.names.iter().zip(&self.counts).filter(|(_, counts)| counts.iter().any(|&count| count > 0));
        occurring.map(move |(name, &counts)| {
            let [right, wrong, missed] = counts;
            let f1 = share(2 * right, 2 * right + wrong + missed);
            (name.as_str(), [share(right, right + wrong), share(right, right + missed), f1], counts)
        })
    }

    /// The table of classes that occur, and its means.
    pub(super) fn report(&self) -> Report {
        let mut sums = [0.0; 3];
        let mut rows = Vec::new();
        for (name, measures, [right, wrong, missed]) in self.classes() {
            sums.iter_mut().zip(measures).for_each(|(sum, measure)| *sum += measure);
            let [precision, recall, f1] = measures.map(rounded);
            rows.push(json!({
                "class": name, "right": right, "false": wrong, "missed": missed,
                "precision": precision, "recall": recall, "f1": f1,
            }));
        }
        let [precision, recall, f1] = sums.map(|sum| rounded(sum / rows.len().max(1) as f64));
        let total = |of: usize| self.counts.iter().map(|counts| counts[of]).sum::<usize>();
        let mut times = self.times.clone();
        times.sort_by(f64::total_cmp);
        Report::new(Outcome::verdict("evaluated"))
            .field("pictures", self.pictures)
            .field("finds", self.finds)
            .field("mean_precision", precision)
            .field("mean_recall", recall)
            .field("mean_f1", f1)
            .field("accuracy", rounded(total(0) as f64 / (total(0) + total(2)).max(1) as f64))
            .field("classes", rows)
            .timing("median_ms", times.get(times.len() / 2).copied().unwrap_or_default())
    }
}
