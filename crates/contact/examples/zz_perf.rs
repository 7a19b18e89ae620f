#![allow(missing_docs)]
#[path = "../tests/common/mod.rs"]
mod common;
use common::*;
use nalgebra::Vector3;
use std::hint::black_box;
use std::time::Instant;
fn main() {
    let h = |u: f64, v: f64| 2.0 * (0.11 * u).sin() * (0.13 * v).cos();
    let (facets, q) = sheet(100, 100, |u, v| [u, v, h(u, v)]);
    let mut search = search(&facets, &q, stoss_contact::SearchOptions::default());
    let n = 200_000;
    let pts: Vec<Vector3<f64>> = (0..n).map(|i| { let u = (i as f64 * 0.754877).fract() * 99.0 + 0.5; let v = (i as f64 * 0.569840).fract() * 99.0 + 0.5;
        Vector3::new(u, v, h(u, v) + 0.1 * (i as f64 * 0.1).sin()) }).collect();
    let t = Instant::now(); for _ in 0..100 { search.update(&q, 0.5); } println!("refit 10k facets {:?}", t.elapsed() / 100);
    let t = Instant::now(); for _ in 0..100 { black_box(search.at(&q)); } println!("view {:?}", t.elapsed() / 100);
    let view = search.at(&q);
    let t = Instant::now(); let mut hints = vec![]; for p in &pts { hints.push(view.closest(p, None).pairing.map(|p| p.facet)); }
    println!("closest {:?}", t.elapsed() / n);
    let t = Instant::now(); for (p, f) in pts.iter().zip(&hints) { black_box(view.pair(p, *f, None)); } println!("pair {:?}", t.elapsed() / n);
    let patches: Vec<_> = hints.iter().map(|f| search.surface().patch(f.unwrap_or(0), &q)).collect();
    let t = Instant::now(); for (p, f) in pts.iter().zip(&patches) { black_box(f.project(p, [0.0; 2])); } println!("project {:?}", t.elapsed() / n);
    let t = Instant::now(); for (p, f) in pts.iter().zip(&patches) { black_box(f.closest_point(p)); } println!("closest_point {:?}", t.elapsed() / n);
    let far: Vec<_> = pts.iter().map(|p| p + Vector3::z() * 5.0).collect();
    let t = Instant::now(); for p in &far { black_box(view.closest(p, None)); } println!("out of reach {:?}", t.elapsed() / n);
}
