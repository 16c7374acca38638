//! How far the encoder is, when it may try several ways.

use super::coarsen::ANALYSIS_SHARE;
use super::options::{Attempt, Progress};

/// Divides the work among all ways that are tried: of each hierarchy the levels, then the passes of each schedule.
pub(super) struct Tries<'a> {
    progress: &'a (dyn Fn(Progress) + Sync),
    hierarchies: Vec<Span>,
    /// The work of all.
    total: f64,
}

/// The work of a hierarchy. That of a single way is 1.
struct Span {
    begin: f64,
    end: f64,
    /// What a hierarchy without levels does not have to do.
    left_out: f64,
}

/// The work of the passes of a schedule.
const PASSES: f64 = 1.0 - ANALYSIS_SHARE;

impl<'a> Tries<'a> {
    pub(super) fn new(
        attempts: &[Attempt],
        num_schedules: usize,
        progress: &'a (dyn Fn(Progress) + Sync),
    ) -> Self {
        let mut total = 0.0;
        let spans = attempts.iter().map(|attempt| {
            let is_flat = attempt.levels == Some(0);
            let left_out = if is_flat { ANALYSIS_SHARE } else { 0.0 };
            let begin = total;
            total += if is_flat { PASSES } else { ANALYSIS_SHARE + num_schedules as f64 * PASSES };
            Span { begin, end: total, left_out }
        });
        Self { progress, hierarchies: spans.collect(), total }
    }

    /// Tells how far it is with a schedule of a hierarchy, `now` being as if there were no other.
    pub(super) fn tell(&self, hierarchy: usize, schedule: usize, now: Progress) {
        let Span { begin, end, left_out } = self.hierarchies[hierarchy];
        let done = (now.fraction - left_out).max(0.0) + schedule as f64 * PASSES;
        (self.progress)(Progress { stage: now.stage, fraction: (begin + done).min(end) / self.total });
    }

    /// Tells that all is done.
    pub(super) fn finish(self) {
        (self.progress)(Progress { stage: "passes", fraction: 1.0 });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn all_ways_together_go_from_0_to_1() {
        let usual = Attempt { levels: None, max_valence: None };
        let flat = Attempt { levels: Some(0), ..usual };
        for (attempts, num_schedules) in [(vec![usual], 1), (vec![usual, usual, flat], 4), (vec![flat], 1)] {
            let told = Mutex::new(vec![0.0]);
            let hear = |now: Progress| told.lock().unwrap().push(now.fraction);
            let tries = Tries::new(&attempts, num_schedules, &hear);
            for hierarchy in 0..attempts.len() {
                for fraction in [0.0, 0.3, ANALYSIS_SHARE] {
                    tries.tell(hierarchy, 0, Progress { stage: "levels", fraction });
                }
                for schedule in 0..num_schedules {
                    for fraction in [ANALYSIS_SHARE, 0.7, 1.0] {
                        tries.tell(hierarchy, schedule, Progress { stage: "passes", fraction });
                    }
                }
            }
            tries.finish();
            let told = told.into_inner().unwrap();
            assert!(told.is_sorted() && told.last() == Some(&1.0), "{told:?}");
        }
    }
}
