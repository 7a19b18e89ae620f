//! Measured curves.

use crate::FitError;

/// A kind of test. The stretch is that of the direction that is pulled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// A bar: free across in both directions. Stretches below one are compression.
    Uniaxial,
    /// A sheet that is pulled alike in both directions.
    Equibiaxial,
    /// A wide strip whose width is held (pure shear).
    Planar,
}

impl Mode {
    /// All kinds of tests.
    pub const ALL: [Self; 3] = [Self::Uniaxial, Self::Equibiaxial, Self::Planar];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Uniaxial => "uniaxial",
            Self::Equibiaxial => "equibiaxial",
            Self::Planar => "planar",
        }
    }

    /// Principal stretches of an incompressible specimen: of the direction that is pulled, of the other one in the plane, across.
    pub fn stretches(self, stretch: f64) -> [f64; 3] {
        match self {
            Self::Uniaxial => [stretch, stretch.powf(-0.5), stretch.powf(-0.5)],
            Self::Equibiaxial => [stretch, stretch, stretch.powi(-2)],
            Self::Planar => [stretch, 1.0, 1.0 / stretch],
        }
    }
}

/// Points of a test: stretch (length over length at rest) and nominal stress (force over area at rest).
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Kind of test.
    pub mode: Mode,
    /// Stretches and stresses, in the order of the table.
    pub points: Vec<[f64; 2]>,
}

impl Curve {
    /// Largest stress, in size.
    pub fn largest_stress(&self) -> f64 {
        self.points.iter().map(|[_, stress]| stress.abs()).fold(0.0, f64::max)
    }
}

/// Curves of a material, at most one of each kind of test.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curves {
    /// Curves in the order in which the table begins them.
    pub all: Vec<Curve>,
}

impl Curves {
    /// The curves from a table with a line of names, `test`, `stretch` or `strain` (nominal), and `stress` (nominal), and a line for each point; values are
    /// separated by commas or semicolons, and `#` begins a comment. Points without strain are left out.
    ///
    /// # Errors
    /// Columns that are missing or unknown, values that are no numbers, a test of another name, a stretch that is not positive, a test without stresses.
    pub fn read(table: &str) -> Result<Self, FitError> {
        let lines = table.lines().enumerate().map(|(k, line)| (k + 1, line.split('#').next().unwrap_or("").trim()));
        let mut lines = lines.filter(|(_, line)| !line.is_empty());
        let wrong =
            |line: usize, message: String, remedy: &str| FitError::Line { line, message, remedy: remedy.into() };
        let names = "write `test, stretch, stress` in the first line";
        let (first, head) = lines.next().ok_or_else(|| wrong(1, "the table is empty".into(), names))?;
        let fields = |line: &str| line.split([',', ';']).map(|field| field.trim().to_lowercase()).collect::<Vec<_>>();
        let head = fields(head);
        let column = |name: &str| head.iter().position(|field| field == name);
        let missing = |name: &str| wrong(first, format!("there is no column `{name}`"), names);
        let (test, stress) =
            (column("test").ok_or_else(|| missing("test"))?, column("stress").ok_or_else(|| missing("stress"))?);
        let (length, at_rest) = match (column("stretch"), column("strain")) {
            (Some(stretch), None) => (stretch, 0.0),
            (None, Some(strain)) => (strain, 1.0),
            (None, None) => return Err(missing("stretch")),
            (Some(_), Some(_)) => {
                return Err(wrong(first, "there are a stretch and a strain".into(), "leave one of them out"));
            }
        };
        let mut curves = Self::default();
        for (line, text) in lines {
            let values = fields(text);
            if values.len() != head.len() {
                let message = format!("has {} values and the table {} columns", values.len(), head.len());
                return Err(wrong(line, message, "write one value for each column"));
            }
            let number = |at: usize| {
                values[at].parse::<f64>().ok().filter(|value| value.is_finite()).ok_or_else(|| {
                    wrong(line, format!("`{}` is no number", values[at]), "write a number, for instance 1.25")
                })
            };
            let mode = Mode::ALL.into_iter().find(|mode| mode.name() == values[test]).ok_or_else(|| {
                let message = format!("`{}` is no test", values[test]);
                wrong(line, message, "write uniaxial, equibiaxial or planar")
            })?;
            let (stretch, stress) = (at_rest + number(length)?, number(stress)?);
            if stretch <= 0.0 {
                let message = format!("the stretch {stretch} is not positive");
                return Err(wrong(line, message, "a stretch is the length over that at rest; a strain is above -1"));
            }
            let curve = match curves.all.iter().position(|curve| curve.mode == mode) {
                Some(known) => known,
                None => {
                    curves.all.push(Curve { mode, points: Vec::new() });
                    curves.all.len() - 1
                }
            };
            if stretch != 1.0 {
                curves.all[curve].points.push([stretch, stress]);
            }
        }
        for curve in &curves.all {
            if curve.largest_stress() == 0.0 {
                let message = format!("the {} test has no point with a strain and a stress", curve.mode.name());
                return Err(wrong(first, message, "add points, or leave the test out"));
            }
        }
        if curves.all.is_empty() {
            return Err(wrong(first, "the table has no points".into(), "add a line for each point"));
        }
        Ok(curves)
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.all.iter().map(|curve| curve.points.len()).sum()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
