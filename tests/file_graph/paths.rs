//! The paths in the code of a file.

/// What a file names.
#[derive(Default)]
pub struct Code {
    pub imports: Vec<Import>,
    /// Paths outside of imports, also those of a single name.
    pub paths: Vec<Vec<String>>,
}

/// One name that `use` brings.
pub struct Import {
    pub path: Vec<String>,
    /// The name it has here.
    pub name: String,
    /// Whether others may use it from here.
    pub is_public: bool,
}

impl Code {
    /// Reads a file without its comments; the tests at its end may use what they like.
    pub fn read(text: &str) -> Self {
        let tokens = tokens(text.split("mod tests {").next().unwrap_or(""));
        let mut code = Self::default();
        let mut at = 0;
        while let Some(&first) = tokens.get(at) {
            if first == "use" {
                // The bracket is that of `pub(crate)`.
                let is_public = at > 0 && matches!(tokens[at - 1], "pub" | ")");
                let length = tokens[at..].iter().take_while(|token| **token != ";").count();
                let mut tree = tokens[at + 1..at + length].iter().copied().peekable();
                read_tree(&mut tree, &[], is_public, &mut code.imports);
                at += length;
            } else if first == "mod" {
                // What it declares is no use of it.
                at += 2;
            } else if is_name(first) {
                let path = path(&tokens[at..]);
                at += 2 * path.len() - 1;
                code.paths.push(path);
            } else {
                at += 1;
            }
        }
        code
    }
}

/// The longest path that the tokens begin with.
fn path(tokens: &[&str]) -> Vec<String> {
    let mut path = vec![tokens[0].to_owned()];
    let mut rest = &tokens[1..];
    while let ["::", name, after @ ..] = rest {
        if !is_name(name) {
            break;
        }
        path.push((*name).to_owned());
        rest = after;
    }
    path
}

/// The names of a tree such as `a::{b, c::{self, d as e}}`, each as one import.
fn read_tree<'a>(
    tokens: &mut std::iter::Peekable<impl Iterator<Item = &'a str>>,
    before: &[String],
    is_public: bool,
    imports: &mut Vec<Import>,
) {
    let mut path = before.to_vec();
    while let Some(token) = tokens.next_if(|token| !matches!(*token, "," | "}" | "as")) {
        match token {
            "{" => {
                while tokens.peek().is_some_and(|token| *token != "}") {
                    read_tree(tokens, &path, is_public, imports);
                    tokens.next_if(|token| *token == ",");
                }
                tokens.next();
                return;
            }
            "::" => {}
            "self" if !path.is_empty() => {}
            name => path.push(name.to_owned()),
        }
    }
    let alias = tokens.next_if(|token| *token == "as").and_then(|_| tokens.next());
    let name = alias.map_or_else(|| path.last().cloned().unwrap_or_default(), str::to_owned);
    imports.push(Import { path, name, is_public });
}

fn is_name(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// Names, `::` and single characters; the spaces between are left out.
fn tokens(mut text: &str) -> Vec<&str> {
    let is_in_name = |c: char| c.is_alphanumeric() || c == '_';
    let mut tokens = Vec::new();
    while let Some(first) = text.chars().next() {
        let length = match first {
            _ if is_in_name(first) => text.find(|c| !is_in_name(c)).unwrap_or(text.len()),
            ':' if text.starts_with("::") => 2,
            _ => first.len_utf8(),
        };
        let (token, rest) = text.split_at(length);
        if !first.is_whitespace() {
            tokens.push(token);
        }
        text = rest;
    }
    tokens
}
