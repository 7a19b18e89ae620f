//! Each scheme's claims on the spring pendulum of formulation §12: `V = c/2 [(|q|^2 - L^2)/(2L)]^2`, a system with angular
//! momentum and energy but without linear momentum, and on a free pair of masses joined by that spring, which has all three.

use stoss_integrators::{ForceRule, SCHEMES, Scheme, State};

const STIFFNESS: f64 = 1.0e3;
const MASS: [f64; 2] = [1.0, 2.0];

/// Potential of the spring of unit length between the two masses, and the force on both for a force rule.
fn potential(q: &[f64]) -> f64 {
    let pi = strain(q);
    0.5 * STIFFNESS * pi * pi
}

fn relative(q: &[f64]) -> [f64; 3] {
    [q[3] - q[0], q[4] - q[1], q[5] - q[2]]
}

/// `(|r|^2 - 1)/2`.
fn strain(q: &[f64]) -> f64 {
    let r = relative(q);
    0.5 * (r.iter().map(|x| x * x).sum::<f64>() - 1.0)
}

fn force(rule: ForceRule, q0: &[f64], q1: &[f64]) -> [f64; 6] {
    let mid: Vec<f64> = q0.iter().zip(q1).map(|(a, b)| 0.5 * (a + b)).collect();
    let (pi, r) = match rule {
        ForceRule::EndPoint => (strain(q1), relative(q1)),
        ForceRule::Midpoint => (strain(&mid), relative(&mid)),
        ForceRule::DiscreteGradient => (0.5 * (strain(q0) + strain(q1)), relative(&mid)),
        _ => unreachable!("new rule: add it to the test"),
    };
    let f = STIFFNESS * pi;
    [-f * r[0], -f * r[1], -f * r[2], f * r[0], f * r[1], f * r[2]]
}

/// One step by Newton with a differenced Jacobian; residuals to round-off.
fn step(scheme: &dyn Scheme, state: &State, dt: f64) -> State {
    let residual = |q1: &[f64]| -> [f64; 6] {
        let mut a = [0.0; 6];
        scheme.acceleration(state, q1, dt, &mut a);
        let f = force(scheme.force_rule(), &state.q, q1);
        std::array::from_fn(|i| MASS[i / 3] * a[i] + f[i])
    };
    let mut q1 = vec![0.0; 6];
    scheme.predict(state, dt, &mut q1);
    for _ in 0..30 {
        let r = residual(&q1);
        let mut k = [[0.0; 7]; 6];
        for j in 0..6 {
            let h = 1.0e-6;
            let mut plus = q1.clone();
            plus[j] += h;
            let mut minus = q1.clone();
            minus[j] -= h;
            let (rp, rm) = (residual(&plus), residual(&minus));
            for i in 0..6 {
                k[i][j] = (rp[i] - rm[i]) / (2.0 * h);
            }
        }
        for i in 0..6 {
            k[i][6] = -r[i];
        }
        let du = gauss(&mut k);
        for j in 0..6 {
            q1[j] += du[j];
        }
        if du.iter().fold(0.0_f64, |m, x| m.max(x.abs())) < 1.0e-15 {
            break;
        }
    }
    let mut v = vec![0.0; 6];
    scheme.update(state, &q1, dt, &mut v);
    State { time: state.time + dt, q: q1, v }
}

fn gauss(k: &mut [[f64; 7]; 6]) -> [f64; 6] {
    for p in 0..6 {
        let best = (p..6).max_by(|&a, &b| k[a][p].abs().total_cmp(&k[b][p].abs())).unwrap_or(p);
        k.swap(p, best);
        for i in p + 1..6 {
            let f = k[i][p] / k[p][p];
            for j in p..7 {
                k[i][j] -= f * k[p][j];
            }
        }
    }
    let mut x = [0.0; 6];
    for i in (0..6).rev() {
        x[i] = (k[i][6] - (i + 1..6).map(|j| k[i][j] * x[j]).sum::<f64>()) / k[i][i];
    }
    x
}

fn start() -> State {
    State {
        time: 0.0,
        q: vec![0.0, 0.0, 0.0, 0.8 / 2.0_f64.sqrt(), 0.1, 0.8 / 2.0_f64.sqrt()],
        v: vec![0.3, 1.0, -0.2, 0.0, -9.0, 0.4],
    }
}

fn run(scheme: &dyn Scheme, dt: f64, steps: usize) -> Vec<State> {
    let mut states = vec![start()];
    for _ in 0..steps {
        let next = step(scheme, &states[states.len() - 1], dt);
        states.push(next);
    }
    states
}

fn momenta_and_energy(s: &State) -> ([f64; 3], [f64; 3], f64) {
    let mut l = [0.0; 3];
    let mut j = [0.0; 3];
    let mut t = potential(&s.q);
    for k in 0..2 {
        let (q, v) = (&s.q[3 * k..3 * k + 3], &s.v[3 * k..3 * k + 3]);
        for i in 0..3 {
            l[i] += MASS[k] * v[i];
            t += 0.5 * MASS[k] * v[i] * v[i];
            j[i] += MASS[k] * (q[(i + 1) % 3] * v[(i + 2) % 3] - q[(i + 2) % 3] * v[(i + 1) % 3]);
        }
    }
    (l, j, t)
}

fn drift(states: &[State]) -> (f64, f64, f64) {
    let (l0, j0, h0) = momenta_and_energy(&states[0]);
    let norm = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let mut worst = (0.0_f64, 0.0_f64, 0.0_f64);
    for s in states {
        let (l, j, h) = momenta_and_energy(s);
        worst.0 = worst.0.max(norm(std::array::from_fn(|i| l[i] - l0[i])) / norm(l0));
        worst.1 = worst.1.max(norm(std::array::from_fn(|i| j[i] - j0[i])) / norm(j0));
        worst.2 = worst.2.max((h / h0 - 1.0).abs());
    }
    worst
}

#[test]
fn every_scheme_conserves_what_it_claims_and_nothing_else() {
    for entry in SCHEMES {
        let scheme = (entry.make)();
        assert_eq!(scheme.name(), entry.name);
        let (l, j, h) = drift(&run(scheme.as_ref(), 0.05, 200));
        let claims = scheme.claims();
        for (what, value, claimed) in [
            ("linear momentum", l, claims.linear_momentum),
            ("angular momentum", j, claims.angular_momentum),
            ("energy", h, claims.energy),
        ] {
            if claimed {
                assert!(value < 1.0e-11, "{}: {what} drifts by {value:e}", entry.name);
            } else {
                assert!(value > 1.0e-6, "{}: {what} is conserved ({value:e}) although not claimed", entry.name);
            }
        }
    }
}

#[test]
fn every_scheme_has_its_order() {
    let end = 0.1;
    // Reference: the finest run of the energy-momentum scheme, Richardson-extrapolated (second order).
    let reference = {
        let scheme = stoss_integrators::EnergyMomentum;
        let coarse = run(&scheme, end / 4000.0, 4000);
        let fine = run(&scheme, end / 8000.0, 8000);
        let (c, f) = (&coarse[4000].q, &fine[8000].q);
        f.iter().zip(c).map(|(f, c)| f + (f - c) / 3.0).collect::<Vec<f64>>()
    };
    for entry in SCHEMES {
        let scheme = (entry.make)();
        let error = |steps: usize| -> f64 {
            let states = run(scheme.as_ref(), end / steps as f64, steps);
            states[steps].q.iter().zip(&reference).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
        };
        let order = (error(200) / error(400)).log2();
        let claimed = f64::from(scheme.claims().order);
        assert!((order - claimed).abs() < 0.02, "{}: order {order}, claimed {claimed}", entry.name);
    }
}
