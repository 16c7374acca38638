//! What is told of losses: once, on standard error or in JSON; with `--strict` they are an error.

use super::exit::Failure;
use super::output::{Destination, print_json_beside};
use super::ui::Ui;
use lwc::losses::{Loss, Losses};
use serde_json::{Value, json};

/// Whether losses are refused.
#[derive(Debug, clap::Args)]
pub struct Strictness {
    /// Fail, before anything is written, if anything is lost on the way: rounded, reordered, left out or renamed. The
    /// error names it all.
    #[arg(long)]
    pub strict: bool,
}

impl Strictness {
    /// # Errors
    /// If there are losses, and none are allowed.
    pub fn check(&self, losses: &Losses) -> Result<(), Failure> {
        if !self.strict || losses.is_empty() {
            return Ok(());
        }
        Err(Failure::Lossy(joined(gathered(losses.iter()).iter())))
    }

    /// As [`Strictness::check`], and prints the losses that are refused as JSON if that is wanted.
    ///
    /// # Errors
    /// As [`Strictness::check`], and if nobody can be told.
    pub fn check_or_print(
        &self,
        losses: &Losses,
        json: bool,
        destination: &Destination,
    ) -> anyhow::Result<()> {
        let checked = self.check(losses);
        if checked.is_err() && json {
            print_json_beside(destination, &json!({ "written": false, "losses": to_json(losses) }))?;
        }
        Ok(checked?)
    }
}

/// Warns of what is lost otherwise than the options say.
pub fn warn(name: &str, losses: &Losses, ui: &Ui) {
    gathered(losses.unusual()).iter().for_each(|loss| ui.warn(name, &loss.to_string()));
}

/// One sentence for names that have kind and remedy in common.
fn gathered<'a>(losses: impl Iterator<Item = &'a Loss>) -> Vec<Loss> {
    let mut sentences: Vec<Loss> = Vec::new();
    let mut subjects: Vec<Vec<&str>> = Vec::new();
    for loss in losses {
        match sentences.iter().position(|known| is_like(known, loss)) {
            Some(known) => subjects[known].push(&loss.subject),
            None => {
                sentences.push(loss.clone());
                subjects.push(vec![&loss.subject]);
            }
        }
    }
    for (sentence, subjects) in sentences.iter_mut().zip(subjects) {
        sentence.subject = enumerated(&subjects);
    }
    sentences
}

/// The first of some names, and how many more there are.
fn enumerated(names: &[&str]) -> String {
    const MOST: usize = 20;
    let shown = names[..names.len().min(MOST)].join(", ");
    if names.len() > MOST { format!("{shown} and {} more", names.len() - MOST) } else { shown }
}

/// Whether two losses differ in what is lost only, and nothing was counted or measured.
fn is_like(known: &Loss, loss: &Loss) -> bool {
    let is_bare = |loss: &Loss| loss.count.is_none() && loss.largest_error.is_none();
    let what = |loss: &'_ Loss| (loss.stage, loss.kind, loss.is_requested);
    is_bare(known) && is_bare(loss) && what(known) == what(loss) && known.remedy == loss.remedy
}

/// One sentence on what is lost as the options say, or nothing.
pub fn usual(losses: &Losses) -> Option<String> {
    let usual: Vec<&Loss> = losses.iter().filter(|loss| loss.is_usual()).collect();
    let plain = |loss: &Loss| loss.clone().remedy("");
    let sentences: Vec<Loss> = gathered(usual.into_iter()).iter().map(plain).collect();
    (!sentences.is_empty()).then(|| format!("lost: {}", joined(sentences.iter())))
}

/// One object for each loss.
pub fn to_json(losses: &Losses) -> Value {
    let one = |loss: &Loss| {
        json!({
            "stage": loss.stage.name(),
            "kind": loss.kind.name(),
            "subject": loss.subject,
            "count": loss.count,
            "total": loss.total,
            "largest_error": loss.largest_error,
            "largest_error_in_edges": loss.largest_error_in_edges,
            "requested": loss.is_requested,
            "remedy": loss.remedy,
            "message": loss.to_string(),
        })
    };
    losses.iter().map(one).collect()
}

fn joined<'a>(losses: impl Iterator<Item = &'a Loss>) -> String {
    losses.map(Loss::to_string).collect::<Vec<_>>().join("; ")
}
