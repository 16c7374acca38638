//! What is told of losses: once, on standard error or in JSON; with `--strict` they are an error.

use super::exit::Failure;
use super::ui::Ui;
use lwc::losses::{Loss, LossKind, Losses, Stage};
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
        Err(Failure::Lossy(joined(losses.iter())))
    }
}

/// Warns of what is lost otherwise than the options say.
pub fn warn(name: &str, losses: &Losses, ui: &Ui) {
    for stage in Stage::ALL {
        let plain = |loss: &&Loss| is_plain(loss) && loss.stage == stage;
        let names: Vec<&str> = losses.unusual().filter(plain).map(|loss| loss.subject.as_str()).collect();
        if !names.is_empty() {
            ui.warn(name, &format!("left out: {}", names.join(", ")));
        }
    }
    losses.unusual().filter(|loss| !is_plain(loss)).for_each(|loss| ui.warn(name, &loss.to_string()));
}

/// One sentence on what is lost as the options say, or nothing.
pub fn usual(losses: &Losses) -> Option<String> {
    let usual: Vec<&Loss> = losses.iter().filter(|loss| loss.is_usual()).collect();
    (!usual.is_empty()).then(|| format!("lost: {}", joined(usual.into_iter())))
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

/// Whether it is a name and nothing else.
fn is_plain(loss: &Loss) -> bool {
    *loss == Loss::new(loss.stage, LossKind::Dropped, loss.subject.as_str())
}

fn joined<'a>(losses: impl Iterator<Item = &'a Loss>) -> String {
    losses.map(Loss::to_string).collect::<Vec<_>>().join("; ")
}
