//! No circle between sibling modules, the second half of `cargo xtask layers`.
//!
//! Siblings are the children of one module. A sibling has an arrow to another if anything in it or below it names
//! anything in or below the other. A name that is re-exported counts as an arrow to each module on the way to the one
//! that defines it. Among siblings no arrows may form a circle, at every level of a crate.
//!
//! A module and its children do not count: the file of a folder holds what its parts share and puts the parts together,
//! so arrows go both ways, and the two are read and moved as one.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::manifest::Member;
use crate::modules::Modules;
use crate::workspace::{Outcome, Workspace};

/// The mentions that make an arrow from one sibling to another.
type Arrows = BTreeMap<(usize, usize), BTreeSet<String>>;

/// Circles of all targets of a member, each as one text.
pub fn check(workspace: &Workspace, member: &Member) -> Outcome<Vec<String>> {
    let source = Path::new(&member.folder).join("src");
    let mut circles = Vec::new();
    for file in workspace.files()?.into_iter().filter(|file| is_root(&source, file)) {
        let modules = Modules::read(&file, &|path| workspace.read(path).ok())?;
        circles.extend(find(&modules));
    }
    Ok(circles)
}

/// True for the root file of a library or of a program.
fn is_root(source: &Path, file: &Path) -> bool {
    let roots: [PathBuf; 2] = ["lib.rs", "main.rs"].map(|root| source.join(root));
    roots.iter().any(|root| root == file) || file.parent() == Some(&source.join("bin"))
}

/// All circles of a crate.
fn find(modules: &Modules) -> Vec<String> {
    let mut arrows = Arrows::new();
    for mention in &modules.mentions {
        let from = modules.line(mention.module);
        for reached in modules.reached(mention) {
            let to = modules.line(reached);
            let common = from.iter().zip(&to).take_while(|(one, other)| one == other).count();
            if let (Some(&one), Some(&other)) = (from.get(common), to.get(common)) {
                let text = format!("{}:{} {}", mention.file, mention.line, mention.path.join("::"));
                arrows.entry((one, other)).or_default().insert(text);
            }
        }
    }
    let reach: Vec<BTreeSet<usize>> = (0..modules.modules.len()).map(|from| reachable(&arrows, from)).collect();
    let mut circles = Vec::new();
    for first in 0..reach.len() {
        let circle: Vec<usize> = reach[first].iter().copied().filter(|other| reach[*other].contains(&first)).collect();
        if circle.first() == Some(&first) {
            circles.push(describe(modules, &arrows, &circle));
        }
    }
    circles
}

fn reachable(arrows: &Arrows, from: usize) -> BTreeSet<usize> {
    let (mut found, mut open) = (BTreeSet::new(), vec![from]);
    while let Some(at) = open.pop() {
        open.extend(arrows.keys().filter(|(one, other)| *one == at && found.insert(*other)).map(|(_, other)| *other));
    }
    found
}

fn describe(modules: &Modules, arrows: &Arrows, circle: &[usize]) -> String {
    let name = |module: usize| modules.modules[module].name.as_str();
    let above = modules.line(circle[0]).into_iter().map(name).collect::<Vec<_>>();
    let members: Vec<&str> = circle.iter().map(|module| name(*module)).collect();
    let parent = above[..above.len() - 1].join("::");
    let mut text = format!("a circle between the modules {} of {parent}", members.join(", "));
    for ((one, other), mentions) in arrows.iter().filter(|((a, b), _)| circle.contains(a) && circle.contains(b)) {
        text += &format!("\n    {} -> {}", name(*one), name(*other));
        mentions.iter().for_each(|mention| text += &format!("\n        {mention}"));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Circles of a made-up crate, given as file names and texts.
    fn circles(files: &[(&str, &str)]) -> Vec<String> {
        let text =
            |path: &Path| files.iter().find(|(name, _)| Path::new(name) == path).map(|(_, text)| (*text).to_owned());
        find(&Modules::read(Path::new(files[0].0), &text).unwrap())
    }

    #[test]
    fn a_circle_is_told_with_its_lines() {
        let root = ("src/lib.rs", "mod a; mod b;");
        let a = ("src/a.rs", "use crate::b::B;\npub struct A(B);");
        let b = ("src/b.rs", "pub struct B;\nfn f() {\n    super::a::A::new();\n}");
        let expected = "a circle between the modules a, b of crate\n    a -> b\n        src/a.rs:1 crate::b::B\n    \
                        b -> a\n        src/b.rs:3 super::a::A::new";
        assert_eq!(circles(&[root, a, b]), [expected]);
        assert!(circles(&[root, a, ("src/b.rs", "pub struct B;")]).is_empty());
        assert!(circles(&[root, ("src/a.rs", "use b::B;"), b]).is_empty(), "b is another crate there");
    }

    #[test]
    fn three_modules_may_form_a_circle() {
        let text =
            "mod a { use super::b::X; } mod b { use super::c::X; } mod c { use super::a::X; } mod d { use super::a; }";
        assert!(circles(&[("src/lib.rs", text)])[0].starts_with("a circle between the modules a, b, c of crate\n"));
    }

    #[test]
    fn re_exports_lead_to_where_the_item_is() {
        let a = ("src/a.rs", "use crate::{Other, c};");
        let b = ("src/b/mod.rs", "mod inner; pub use inner::Thing;");
        let inner = ("src/b/inner.rs", "use crate::a; pub struct Thing;");
        for root in ["mod a; mod b; pub use b::Thing as Other;", "mod a; mod b; pub use self::b::{self as c};"] {
            assert_eq!(circles(&[("src/lib.rs", root), a, b, inner]).len(), 1, "{root}");
        }
        assert!(circles(&[("src/lib.rs", "mod a; mod b; pub use x::Other;"), a, b, inner]).is_empty());
        // The way goes through b, although c defines the item.
        let text = "mod a { use super::b::X; } mod b { pub use super::c::X; use super::a; } mod c { pub struct X; }";
        assert!(circles(&[("src/lib.rs", text)])[0].starts_with("a circle between the modules a, b of"));
    }

    #[test]
    fn a_module_and_a_function_of_one_name_are_both_followed() {
        let text =
            "mod solve { pub fn solve() { crate::a::f() } } mod a { fn f() { crate::solve(); } } pub use solve::solve;";
        assert_eq!(circles(&[("src/lib.rs", text)]).len(), 1);
        let text = "mod scheme { pub struct S; } mod list { pub fn scheme() { crate::user::f() } } mod user { use crate::S; }\
                    pub use list::scheme; pub use scheme::S;";
        assert!(circles(&[("src/lib.rs", text)]).is_empty(), "a struct is not in a function");
    }

    #[test]
    fn nested_modules_count_for_the_siblings_above_them() {
        let root = ("src/lib.rs", "mod a; mod b;");
        let a = ("src/a.rs", "mod deep { mod deeper { use super::super::super::b::B; } } pub struct A;");
        assert_eq!(circles(&[root, a, ("src/b.rs", "use crate::a::A; pub struct B;")]).len(), 1);
        let text = "mod top { mod a { use super::b; } mod b { use super::a; } }";
        assert!(circles(&[("src/main.rs", text)])[0].starts_with("a circle between the modules a, b of crate::top\n"));
    }

    #[test]
    fn globs_are_looked_through() {
        let text =
            "mod a { pub use super::b::*; pub struct A; } mod b { use super::a::*; pub struct B; fn f(_: A) {} }";
        assert_eq!(circles(&[("src/lib.rs", text)]).len(), 1);
        // Only X of b stands behind the name of a; c is searched, but not named.
        let text = "mod a { use super::*; fn f(_: X) {} } mod b { use crate::a; pub struct X; } mod c { use crate::a; }\
                    pub use b::*; pub use c::*;";
        assert!(circles(&[("src/lib.rs", text)])[0].starts_with("a circle between the modules a, b of crate\n"));
    }

    #[test]
    fn paths_inside_macros_count() {
        let text = "mod a { fn f() { print!(\"{}\", crate::b::X); } } mod b { use crate::a; }";
        assert_eq!(circles(&[("src/lib.rs", text)]).len(), 1);
    }

    #[test]
    fn tests_comments_and_strings_do_not_count() {
        for user in [
            "#[cfg(test)] mod tests { use crate::b::B; }",
            "#[cfg(test)] mod missing;",
            "#[cfg(all(test, unix))] use crate::b;",
            "struct A; impl A { #[cfg(test)] fn f() { crate::b::g() } }",
            "//! [`crate::b::B`]\n/// use crate::b;\n/* crate::b */ pub struct A;",
            "const A: &str = \"crate::b::B\"; fn f() { print!(\"crate::b\"); }",
        ] {
            let files =
                [("src/lib.rs", "mod a; mod b;"), ("src/a.rs", user), ("src/b.rs", "use crate::a; pub struct B;")];
            assert!(circles(&files).is_empty(), "{user}");
        }
        let text = "mod a { #[cfg(not(test))] use super::b; } mod b { use super::a; }";
        assert_eq!(circles(&[("src/lib.rs", text)]).len(), 1);
    }

    #[test]
    fn parent_and_child_are_one() {
        let text = "mod a { use super::Root; pub struct A; } use a::A; pub struct Root(A);";
        assert!(circles(&[("src/lib.rs", text)]).is_empty());
    }
}
