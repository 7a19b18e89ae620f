//! What other programs reached on the same problems: rows of `peers.csv`, which `scripts/peers.py` writes.

use std::fmt::Write;

use crate::plot::Series;
use crate::workspace::Outcome;

/// A run of another program that came to its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Peer {
    /// Name of the problem.
    pub problem: String,
    /// Program and its kind of cell.
    pub name: String,
    /// Elements, as the problem counts them.
    pub mesh: u32,
    /// CPU seconds of the whole process.
    pub cpu_seconds: f64,
    /// Peak of the resident memory in MB.
    pub memory: f64,
    /// Relative error of the first quantity.
    pub error: f64,
}

/// Reads the file; runs that failed are left out. An error names the line.
pub fn parse(text: &str) -> Outcome<Vec<Peer>> {
    let mut peers = Vec::new();
    for (number, line) in text.lines().enumerate().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let [problem, program, cell, mesh, ending, cpu_seconds, memory, error] = cells[..] else {
            return Err(format!("peers.csv, line {}: {} columns in place of 8", number + 1, cells.len()).into());
        };
        if ending == "ok" {
            let name = format!("{program} {cell}");
            let [cpu_seconds, memory, error] = [cpu_seconds.parse()?, memory.parse()?, error.parse()?];
            peers.push(Peer { problem: problem.to_owned(), name, mesh: mesh.parse()?, cpu_seconds, memory, error });
        }
    }
    Ok(peers)
}

/// Names in the order of the file, each once.
fn names<'a>(peers: &'a [&Peer]) -> Vec<&'a str> {
    let mut names: Vec<&str> = Vec::new();
    for peer in peers {
        if !names.contains(&peer.name.as_str()) {
            names.push(&peer.name);
        }
    }
    names
}

/// A line of error against CPU seconds for each program and cell.
pub fn series(peers: &[&Peer]) -> Vec<Series> {
    let line = |name: &str| {
        let own = peers.iter().filter(|peer| peer.name == name);
        Series { name: name.to_owned(), points: own.map(|peer| (peer.cpu_seconds, peer.error)).collect() }
    };
    names(peers).into_iter().map(line).collect()
}

/// The table; empty without runs.
pub fn table(peers: &[&Peer], quantity: &str) -> String {
    if peers.is_empty() {
        return String::new();
    }
    let mut text = format!(
        "\nOther programs, same meshes and loads (`scripts/peers.py`):\n\n| program | elements | error of {quantity} | CPU, finest | MB, finest |\n|---|---|---|---|---|\n"
    );
    for name in names(peers) {
        let own: Vec<&&Peer> = peers.iter().filter(|peer| peer.name == name).collect();
        let joined = |word: fn(&Peer) -> String| own.iter().map(|peer| word(peer)).collect::<Vec<_>>().join(", ");
        let last = own[own.len() - 1];
        let _ = writeln!(
            text,
            "| {name} | {} | {} | {} | {:.0} |",
            joined(|peer| peer.mesh.to_string()),
            joined(|peer| format!("{:.1e}", peer.error)),
            super::front::seconds(last.cpu_seconds),
            last.memory
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_that_failed_are_left_out_and_short_lines_refused() {
        let head = "problem,program,cell,mesh,ending,cpu_seconds,memory_mb,error\n";
        let peers =
            parse(&format!("{head}a,P,C,2,ok,1e-1,16.0,1e-2\na,P,C,4,failed: no,,,\na,P,C,8,ok,1,20,1e-3\n")).unwrap();
        let all: Vec<&Peer> = peers.iter().collect();
        assert_eq!(series(&all)[0].points, [(0.1, 0.01), (1.0, 0.001)]);
        assert!(table(&all, "force").contains("| P C | 2, 8 | 1.0e-2, 1.0e-3 | 1 s | 20 |"));
        assert!(parse(&format!("{head}a,P\n")).is_err());
        assert_eq!(table(&[], "force"), "");
    }
}
