//! Elements of all kinds: incompressibility, convergence, conservation in flight.

mod closed_forms;
pub(super) mod equilibrium;
mod hertz;
mod inf_sup;
pub(super) mod manufactured;

use stoss_reference_element::{CellKind, Integration};

use super::check::{Bound, Check};
use super::report::{Grid, ReportSection};
use super::{Bench, Findings, Suite, facade};
use crate::verify::numbers::{distance, larger, norm};
use crate::workspace::Outcome;

/// Elements of all kinds.
pub struct Elements;

/// Relative drift of momenta and of the energy.
const DRIFT: f64 = 1e-11;

impl Suite for Elements {
    fn name(&self) -> &'static str {
        "elements"
    }

    fn about(&self) -> &'static str {
        "Free flights, rates of convergence and incompressibility of each kind of cell."
    }

    fn measure(&self, bench: &Bench) -> Outcome<Findings> {
        let mut findings = Findings::default();
        flights(&mut findings, bench.quick)?;
        manufactured::measure(&mut findings, bench.quick)?;
        closed_forms::measure(&mut findings, bench.quick)?;
        inf_sup::measure(&mut findings, bench.quick)?;
        if !bench.quick {
            hertz::measure(&mut findings)?;
        }
        Ok(findings)
    }
}

/// A cell and its quadrature in words.
pub(super) fn name(kind: CellKind, integration: Integration) -> String {
    match integration {
        Integration::Full => kind.name().to_owned(),
        Integration::Reduced => format!("{}, reduced", kind.name()),
    }
}

/// Keys of a `[[body]]` for a cell and its quadrature.
pub(super) fn keys(kind: CellKind, integration: Integration) -> String {
    let rule = match integration {
        Integration::Full => "full",
        Integration::Reduced => "reduced",
    };
    format!("cell = \"{}\"\nintegration = \"{rule}\"\n", kind.name())
}

fn table(findings: &mut Findings, caption: &str, reading: &str, head: &[&str], rows: Vec<Vec<String>>) {
    findings.sections.push(ReportSection {
        title: caption.into(),
        reading: reading.into(),
        figures: Vec::new(),
        tables: vec![Grid { caption: caption.into(), head: head.iter().map(|h| (*h).to_owned()).collect(), rows }],
    });
}

/// Free flight, turning and stretched: each cell with each law, and with averages near incompressibility.
fn flights(findings: &mut Findings, quick: bool) -> Outcome<()> {
    const LAWS: [(&str, &str); 7] = [
        ("saint-venant-kirchhoff", "law = \"saint-venant-kirchhoff\", young = 100.0, poisson = 0.3"),
        ("neo-hooke", "law = \"neo-hooke\", young = 100.0, poisson = 0.3"),
        ("mooney-rivlin", "law = \"mooney-rivlin\", c1 = 12.0, c2 = 6.0, c = 80.0"),
        ("ogden", "law = \"ogden\", mu = [63.0, 0.12, -1.0], alpha = [1.3, 5.0, -2.0], kappa = 100.0, beta = 9.0"),
        ("neo-hooke, mixed", "law = \"neo-hooke\", young = 100.0, poisson = 0.4999"),
        ("mooney-rivlin, mixed", "law = \"mooney-rivlin\", c1 = 12.0, c2 = 6.0, c = 1e5"),
        ("ogden, mixed", "law = \"ogden\", mu = [63.0, 0.12, -1.0], alpha = [1.3, 5.0, -2.0], kappa = 2e5, beta = 9.0"),
    ];
    let mut rows = Vec::new();
    for (k, cell) in CellKind::ALL.into_iter().map(CellKind::name).enumerate() {
        let mut row = vec![cell.to_owned()];
        for (l, (law, material)) in LAWS.into_iter().enumerate() {
            if quick && (k + l) % 3 != 0 {
                row.push(String::new());
                continue;
            }
            let volumetric = if law.ends_with("mixed") { "volumetric = \"mixed\"\n" } else { "" };
            let text = format!(
                "[scene]\ntitle = \"flight\"\nkind = \"dynamic\"\n[time]\nend = 1.0\nstep = 0.05\nintegrator = {{ scheme = \"energy-momentum\" }}\n\
                 [[body]]\nname = \"a\"\ncell = \"{cell}\"\n{volumetric}material = {{ {material} }}\ndensity = 1.0\nvelocity = [0.2, -0.1, 0.3]\n\
                 angular_velocity = [0.3, 1.0, 0.2]\nvelocity_gradient = [[0.5, 0, 0], [0, -0.25, 0], [0, 0, -0.25]]\n\
                 mesh = {{ generator = \"block\", min = [0, 0, 0], max = [2, 1, 1], divisions = [2, 1, 1] }}\n"
            );
            let mut simulation = facade::simulation(&text)?;
            let start = *simulation.balance();
            let mut drift = [0.0_f64; 3];
            while !simulation.finished() {
                simulation.advance()?;
                let now = simulation.balance();
                let values = [
                    distance(now.linear_momentum, start.linear_momentum) / norm(start.linear_momentum),
                    distance(now.angular_momentum, start.angular_momentum) / norm(start.angular_momentum),
                    (now.total() / start.total() - 1.0).abs(),
                ];
                for (drift, value) in drift.iter_mut().zip(values) {
                    *drift = larger(*drift, value);
                }
            }
            let scene = format!("flight, {cell}, {law}");
            for (quantity, drift) in ["linear momentum", "angular momentum", "energy"].into_iter().zip(drift) {
                let check = Check::new(&scene, format!("drift of the {quantity}"), drift, Bound::AtMost(DRIFT));
                findings.checks.push(check);
            }
            row.push(format!("{:.0e}", drift.into_iter().fold(0.0, larger)));
        }
        rows.push(row);
    }
    let head: Vec<&str> = std::iter::once("cell").chain(LAWS.map(|(law, _)| law)).collect();
    table(
        findings,
        "Free flight: largest drift of momenta and energy",
        "A body of each cell with each law spins and vibrates freely. Only round-off may change momenta and energy.",
        &head,
        rows,
    );
    Ok(())
}
