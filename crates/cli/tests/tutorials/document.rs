//! The blocks of a tutorial and what they are for.

use super::comparison::Tolerance;

/// What a reader does with a block; see the table at the head of the module above.
pub enum Role {
    File(String),
    Append(String),
    PartOf(String),
    NotRun,
    Run { exit: i32, expected: Option<(Vec<(usize, String)>, Tolerance)> },
}

/// A fenced block.
pub struct Block {
    /// Line of the opening fence, counted from 1.
    pub line: usize,
    pub role: Role,
    pub lines: Vec<String>,
}

impl Block {
    pub fn content(&self) -> String {
        self.lines.iter().map(|line| format!("{line}\n")).collect()
    }

    /// Commands with the lines where they begin: one a line, but a backslash at the end of a line goes on with the next one.
    pub fn commands(&self) -> Vec<(usize, String)> {
        let mut commands: Vec<(usize, String)> = Vec::new();
        let mut goes_on = false;
        for (number, line) in self.lines.iter().enumerate() {
            match commands.last_mut().filter(|_| goes_on) {
                Some((_, command)) => {
                    command.push('\n');
                    command.push_str(line);
                }
                None if line.trim().is_empty() || line.trim_start().starts_with('#') => continue,
                None => commands.push((self.line + 1 + number, line.clone())),
            }
            goes_on = line.ends_with('\\');
        }
        commands
    }
}

/// A tutorial.
pub struct Document {
    pub blocks: Vec<Block>,
    /// Pictures in `figures/` that the text shows, with their lines.
    pub pictures: Vec<(usize, String)>,
}

impl Document {
    pub fn parse(name: &str, text: &str) -> Result<Self, String> {
        let mut document = Self { blocks: Vec::new(), pictures: Vec::new() };
        // Whether nothing but empty lines came after a block that `text` may follow.
        let mut follows = false;
        let mut lines = text.lines().enumerate();
        while let Some((number, line)) = lines.next() {
            let at = number + 1;
            let Some(info) = line.strip_prefix("```") else {
                if line.contains("```") {
                    return Err(format!("{name}:{at}: the fence of a block stands at the beginning of its line"));
                }
                follows &= line.trim().is_empty();
                document.pictures.extend(pictures(line).map(|picture| (at, picture)));
                continue;
            };
            let mut content = Vec::new();
            loop {
                match lines.next() {
                    Some((_, line)) if line.trim_end() == "```" => break,
                    Some((_, line)) => content.push(line.to_owned()),
                    None => return Err(format!("{name}:{at}: the block is not closed")),
                }
            }
            let words: Vec<&str> = info.split_whitespace().collect();
            let problem = |message: &str| format!("{name}:{at}: ```{info}: {message}");
            if words.first() == Some(&"text") {
                let Some(Role::Run { expected, .. }) =
                    document.blocks.last_mut().map(|block| &mut block.role).filter(|_| follows)
                else {
                    return Err(problem("output stands directly behind the block `sh` that prints it"));
                };
                let tolerance = tolerance(&words[1..]).map_err(|message| problem(&message))?;
                let numbered = content.into_iter().enumerate().map(|(number, line)| (at + 1 + number, line));
                *expected = Some((numbered.collect(), tolerance));
                follows = false;
                continue;
            }
            let role = role(&words).map_err(|message| problem(&message))?;
            follows = matches!(role, Role::Run { .. });
            document.blocks.push(Block { line: at, role, lines: content });
        }
        Ok(document)
    }
}

fn role(words: &[&str]) -> Result<Role, String> {
    match *words {
        ["sh"] => Ok(Role::Run { exit: 0, expected: None }),
        ["sh", "not-run"] => Ok(Role::NotRun),
        ["sh", option] => {
            let exit = option.strip_prefix("exit=").and_then(|code| code.parse().ok());
            Ok(Role::Run {
                exit: exit.ok_or_else(|| format!("`{option}` is not known; `exit=N` and `not-run` are"))?,
                expected: None,
            })
        }
        [_, option] => match option.split_once('=') {
            Some(("file", file)) => Ok(Role::File(file.to_owned())),
            Some(("append", file)) => Ok(Role::Append(file.to_owned())),
            Some(("part-of", file)) => Ok(Role::PartOf(file.to_owned())),
            _ => Err(format!("`{option}` is not known; `file=NAME`, `append=NAME` and `part-of=NAME` are")),
        },
        _ => Err("a block needs a role: `LANGUAGE file=NAME`, `sh`, or `text` behind `sh`".to_owned()),
    }
}

fn tolerance(options: &[&str]) -> Result<Tolerance, String> {
    let mut tolerance = Tolerance { relative: 1e-6, zero: 0.0 };
    for option in options {
        let value = |text: &str| text.parse::<f64>().map_err(|_| format!("`{option}` has no number"));
        match option.split_once('=') {
            Some(("tolerance", text)) => tolerance.relative = value(text)?,
            Some(("zero", text)) => tolerance.zero = value(text)?,
            _ => return Err(format!("`{option}` is not known; `tolerance=R` and `zero=Z` are")),
        }
    }
    Ok(tolerance)
}

/// Pictures in `figures/` that a line of Markdown shows.
fn pictures(line: &str) -> impl Iterator<Item = String> {
    line.split("](figures/").skip(1).filter_map(|rest| rest.split_once(')')).map(|(name, _)| format!("figures/{name}"))
}
