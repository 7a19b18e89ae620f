//! `cargo xtask api`: the public items of each published crate, one a line in `docs/api/`, so that whoever changes an interface sees it in the diff.
//!
//! Items are found in the sources, whatever the features; re-exports are followed inside the crate. What a macro writes, and the values of
//! constants, are not seen.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use quote::ToTokens;
use syn::{Attribute, Fields, ImplItem, Item, ItemImpl, ItemTrait, TraitItem, UseTree, Visibility};

use crate::manifest;
use crate::workspace::{Outcome, Workspace, write};

/// A module: what it defines, re-exports and contains.
#[derive(Debug, Default)]
struct Scope {
    parent: usize,
    /// Public items with their lines, which begin with the name.
    items: BTreeMap<String, Vec<String>>,
    /// Public re-exports: the name, nothing for all names, and the path.
    exports: Vec<(Option<String>, Vec<String>)>,
    /// Modules inside, and whether they are public.
    children: BTreeMap<String, (usize, bool)>,
}

/// A crate; scope 0 is its root.
#[derive(Debug, Default)]
struct Interface {
    scopes: Vec<Scope>,
    /// Lines of the implementations for a type of that name; they begin with what stands behind the name.
    implementations: BTreeMap<String, Vec<String>>,
}

/// Compares the lists with what the sources say, or writes them with `bless`; false if they differ.
pub fn command(workspace: &Workspace, bless: bool) -> Outcome<bool> {
    let (mut good, mut count) = (true, 0);
    for member in manifest::members(workspace)?.iter().filter(|member| member.is_published()) {
        let name = member.crate_name().unwrap_or(&member.folder);
        let root = workspace.path(format!("{}/src/lib.rs", member.folder));
        let found = list(&root, &member.name.replace('-', "_"), &|path| std::fs::read_to_string(path).ok())?;
        count += found.len();
        let file = workspace.path(format!("docs/api/{name}.txt"));
        if bless {
            write(&file, &found.iter().map(|line| format!("{line}\n")).collect::<String>())?;
            continue;
        }
        let text = std::fs::read_to_string(&file).unwrap_or_default();
        let committed: BTreeSet<String> = text.lines().map(str::to_owned).collect();
        let removed = committed.difference(&found).map(|line| format!("- {line}"));
        for difference in removed.chain(found.difference(&committed).map(|line| format!("+ {line}"))) {
            println!("api: docs/api/{name}.txt: {difference}");
            good = false;
        }
    }
    let rest = match (bless, good) {
        (true, _) => "written to docs/api",
        (false, true) => "as in docs/api",
        (false, false) => "; `cargo xtask api --bless` accepts the changes, CHANGELOG.md tells them",
    };
    println!("api: {count} public items {rest}");
    Ok(good)
}

/// The public items of a crate from its root file; `text` gives the text of a file if there is one.
fn list(root: &Path, name: &str, text: &dyn Fn(&Path) -> Option<String>) -> Outcome<BTreeSet<String>> {
    let mut interface = Interface::default();
    let folder = root.parent().unwrap_or(root).to_path_buf();
    interface.file(root, &folder, 0, text)?;
    let mut lines = BTreeSet::new();
    interface.collect(0, name, &mut Vec::new(), &mut lines);
    Ok(lines)
}

impl Interface {
    fn file(
        &mut self,
        file: &Path,
        folder: &Path,
        parent: usize,
        text: &dyn Fn(&Path) -> Option<String>,
    ) -> Outcome<usize> {
        let content = text(file).ok_or_else(|| format!("{}: no such file", file.display()))?;
        let parsed = syn::parse_file(&content).map_err(|error| format!("{}: {error}", file.display()))?;
        self.scope(&parsed.items, folder, parent, text)
    }

    fn scope(
        &mut self,
        items: &[Item],
        folder: &Path,
        parent: usize,
        text: &dyn Fn(&Path) -> Option<String>,
    ) -> Outcome<usize> {
        let at = self.scopes.len();
        self.scopes.push(Scope { parent, ..Scope::default() });
        for item in items.iter().filter(|item| !is_test(attributes(item))) {
            match item {
                Item::Mod(module) => {
                    let name = module.ident.to_string();
                    let child = match &module.content {
                        Some((_, items)) => self.scope(items, &folder.join(&name), at, text)?,
                        None => {
                            let paths = [folder.join(format!("{name}.rs")), folder.join(&name).join("mod.rs")];
                            let file: &PathBuf = paths.iter().find(|path| text(path).is_some()).unwrap_or(&paths[0]);
                            self.file(file, &folder.join(&name), at, text)?
                        }
                    };
                    self.scopes[at].children.insert(name, (child, is_public(&module.vis)));
                }
                Item::Use(of) if is_public(&of.vis) => exports(&of.tree, &[], &mut self.scopes[at].exports),
                Item::Impl(of) => self.implementation(of),
                _ => {
                    if let Some((name, lines)) = described(item) {
                        self.scopes[at].items.entry(name).or_default().extend(lines);
                    }
                }
            }
        }
        Ok(at)
    }

    fn implementation(&mut self, of: &ItemImpl) {
        let syn::Type::Path(path) = &*of.self_ty else { return };
        let Some(last) = path.path.segments.last() else { return };
        let lines = self.implementations.entry(last.ident.to_string()).or_default();
        if let Some((bang, path, _)) = &of.trait_ {
            let generics = of.generics.params.to_token_stream();
            let not = if bang.is_some() { "!" } else { "" };
            return lines.push(
                format!(": impl<{}> {not}{} for {}", plain(generics), plain(path), plain(&of.self_ty))
                    .replace("impl<>", "impl"),
            );
        }
        for item in of.items.iter() {
            match item {
                ImplItem::Fn(f) if is_public(&f.vis) && !is_test(&f.attrs) => {
                    lines.push(format!("::{}: {}", f.sig.ident, plain(&f.sig)));
                }
                ImplItem::Const(c) if is_public(&c.vis) => lines.push(format!("::{}: const {}", c.ident, plain(&c.ty))),
                _ => {}
            }
        }
    }

    /// Adds the lines of a scope that is public as `prefix`; `open` has the scopes in work, for modules may re-export each other.
    fn collect(&self, at: usize, prefix: &str, open: &mut Vec<usize>, lines: &mut BTreeSet<String>) {
        if open.contains(&at) {
            return;
        }
        open.push(at);
        let scope = &self.scopes[at];
        for name in scope.items.keys() {
            self.item(at, name, name, prefix, lines);
        }
        for (name, _) in scope.children.iter().filter(|(_, (_, public))| *public) {
            self.collect(scope.children[name].0, &format!("{prefix}::{name}"), open, lines);
        }
        for (name, path) in &scope.exports {
            self.export(at, name.as_deref(), path, prefix, open, lines);
        }
        open.pop();
    }

    fn item(&self, at: usize, name: &str, shown: &str, prefix: &str, lines: &mut BTreeSet<String>) {
        let own = self.scopes[at].items.get(name).into_iter().flatten();
        let implementations = self.implementations.get(name).into_iter().flatten();
        let is_type =
            own.clone().any(|line| [": struct", ": enum", ": union"].iter().any(|kind| line.starts_with(kind)));
        lines.extend(own.chain(implementations.filter(|_| is_type)).map(|line| format!("{prefix}::{shown}{line}")));
    }

    fn export(
        &self,
        at: usize,
        name: Option<&str>,
        path: &[String],
        prefix: &str,
        open: &mut Vec<usize>,
        lines: &mut BTreeSet<String>,
    ) {
        let (last, before) = match (name, path.split_last()) {
            (Some(_), Some((last, before))) => (Some(last.as_str()), before),
            _ => (None, path),
        };
        let mut scope = Some(at);
        for (position, word) in before.iter().enumerate() {
            scope = scope.and_then(|scope| match word.as_str() {
                "crate" => Some(0),
                "self" => Some(scope),
                "super" => Some(self.scopes[scope].parent),
                word => self.scopes[scope].children.get(word).map(|(child, _)| *child),
            });
            // The first word may be another crate.
            if position == 0 && scope.is_none() {
                break;
            }
        }
        let elsewhere = format!("{prefix}::{}: use {}", name.unwrap_or("*"), path.join("::"));
        match (scope, last, name) {
            (Some(scope), None, _) => self.collect(scope, prefix, open, lines),
            (Some(scope), Some(last), Some(name)) if self.scopes[scope].items.contains_key(last) => {
                self.item(scope, last, name, prefix, lines);
                // A module may have the name of its item, and be public too.
            }
            (Some(scope), Some(last), Some(name)) if self.scopes[scope].children.contains_key(last) => {
                self.collect(self.scopes[scope].children[last].0, &format!("{prefix}::{name}"), open, lines);
            }
            (Some(scope), Some(last), Some(_)) if scope != at => {
                let again = self.scopes[scope].exports.iter().find(|(name, _)| name.as_deref() == Some(last));
                match again {
                    Some((_, path)) => self.export(scope, name, path, prefix, open, lines),
                    None => drop(lines.insert(elsewhere)),
                }
            }
            _ => drop(lines.insert(elsewhere)),
        }
    }
}

/// Name and lines of a public item; the lines begin with what stands behind the name.
fn described(item: &Item) -> Option<(String, Vec<String>)> {
    let (vis, name) = match item {
        Item::Fn(f) => (&f.vis, &f.sig.ident),
        Item::Const(c) => (&c.vis, &c.ident),
        Item::Static(s) => (&s.vis, &s.ident),
        Item::Type(t) => (&t.vis, &t.ident),
        Item::Struct(s) => (&s.vis, &s.ident),
        Item::Enum(e) => (&e.vis, &e.ident),
        Item::Trait(t) => (&t.vis, &t.ident),
        _ => return None,
    };
    if !is_public(vis) {
        return None;
    }
    let lines = match item {
        Item::Fn(f) => vec![format!(": {}", plain(&f.sig))],
        Item::Const(c) => vec![format!(": const {}", plain(&c.ty))],
        Item::Static(s) => vec![format!(": static {}", plain(&s.ty))],
        Item::Type(t) => vec![format!(": type{} = {}", plain(&t.generics), plain(&t.ty))],
        Item::Struct(s) => {
            let hidden = if s.fields.iter().all(|field| is_public(&field.vis)) { "" } else { ", with private fields" };
            let mut lines = vec![format!(": struct{}{hidden}{}", plain(&s.generics), marks(&s.attrs))];
            let public = s.fields.iter().enumerate().filter(|(_, field)| is_public(&field.vis));
            lines.extend(public.map(|(at, field)| {
                let name = field.ident.as_ref().map_or_else(|| at.to_string(), ToString::to_string);
                format!(".{name}: {}", plain(&field.ty))
            }));
            lines
        }
        Item::Enum(e) => {
            let mut lines = vec![format!(": enum{}{}", plain(&e.generics), marks(&e.attrs))];
            lines.extend(e.variants.iter().map(|variant| format!("::{}{}", variant.ident, fields(&variant.fields))));
            lines
        }
        Item::Trait(t) => trait_lines(t),
        _ => return None,
    };
    Some((name.to_string(), lines))
}

fn fields(fields: &Fields) -> String {
    let one = |field: &syn::Field| match &field.ident {
        Some(name) => format!("{name}: {}", plain(&field.ty)),
        None => plain(&field.ty),
    };
    let all = fields.iter().map(one).collect::<Vec<_>>().join(", ");
    match fields {
        Fields::Named(_) => format!(" {{ {all} }}"),
        Fields::Unnamed(_) => format!("({all})"),
        Fields::Unit => String::new(),
    }
}

fn trait_lines(t: &ItemTrait) -> Vec<String> {
    let above = if t.supertraits.is_empty() { String::new() } else { format!(": {}", plain(&t.supertraits)) };
    let mut lines = vec![format!(": trait{}{above}", plain(&t.generics))];
    for item in &t.items {
        match item {
            TraitItem::Fn(f) => {
                let kind = if f.default.is_some() { "provided" } else { "required" };
                lines.push(format!("::{}: {kind} {}", f.sig.ident, plain(&f.sig)));
            }
            TraitItem::Const(c) => lines.push(format!("::{}: const {}", c.ident, plain(&c.ty))),
            TraitItem::Type(a) => lines.push(format!("::{}: type {}", a.ident, plain(&a.bounds)).trim_end().into()),
            _ => {}
        }
    }
    lines
}

/// Derived traits and `non_exhaustive`, which are a part of the interface.
fn marks(attributes: &[Attribute]) -> String {
    let known = ["derive", "non_exhaustive"];
    let marks = attributes.iter().filter(|attribute| known.iter().any(|name| attribute.path().is_ident(name)));
    marks.map(|attribute| format!(", {}", plain(&attribute.meta))).collect()
}

/// Public re-exports of a `use`.
fn exports(tree: &UseTree, before: &[String], out: &mut Vec<(Option<String>, Vec<String>)>) {
    let join = |ident: &syn::Ident| before.iter().cloned().chain([ident.to_string()]).collect::<Vec<_>>();
    match tree {
        UseTree::Path(path) => exports(&path.tree, &join(&path.ident), out),
        UseTree::Group(group) => group.items.iter().for_each(|item| exports(item, before, out)),
        UseTree::Glob(_) => out.push((None, before.to_vec())),
        UseTree::Name(name) => out.push((Some(name.ident.to_string()), join(&name.ident))),
        UseTree::Rename(rename) => out.push((Some(rename.rename.to_string()), join(&rename.ident))),
    }
}

fn is_public(vis: &Visibility) -> bool {
    matches!(vis, Visibility::Public(_))
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Mod(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        _ => &[],
    }
}

fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| attribute.path().is_ident("cfg") && plain(&attribute.meta).contains("(test"))
}

/// Tokens as a line of code, with blanks where people write them.
fn plain(tokens: impl ToTokens) -> String {
    let mut text = tokens.to_token_stream().to_string().split_whitespace().collect::<Vec<_>>().join(" ");
    for (from, to) in [
        (" ,", ","),
        (" ;", ";"),
        (" :: ", "::"),
        (":: ", "::"),
        (" : ", ": "),
        (" (", "("),
        ("( ", "("),
        (" )", ")"),
        ("[ ", "["),
        (" ]", "]"),
        (" < ", "<"),
        ("< ", "<"),
        (" <", "<"),
        (" > ", "> "),
        (" >", ">"),
        ("& ", "&"),
        ("->(", "-> ("),
        ("' ", "'"),
        ("# [", "#["),
        (",)", ")"),
        (",]", "]"),
    ] {
        text = text.replace(from, to);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROOT: &str = "
        mod inner;
        pub mod open { pub const SIZE: usize = 3; fn hidden() {} pub(crate) fn crate_only() {} }
        pub use inner::{Law, solve as find};
        pub use other_crate::Thing;
        #[cfg(test)] pub fn of_tests() {}
    ";
    const INNER: &str = "
        #[derive(Clone, Debug)] #[non_exhaustive]
        pub struct Law { pub modulus: f64, secret: u8 }
        impl Law { pub fn energy(&self, c: &[f64; 6]) -> Result<f64, Error> { todo } fn own(&self) {} }
        impl std::fmt::Display for Law {}
        pub struct Unseen;
        pub fn solve<T: Copy>(x: T) -> T { x }
        pub trait Part { const N: usize; fn name(&self) -> &str; fn mass(&self) -> f64 { 0.0 } }
    ";

    fn of(root: &str, inner: &str) -> Vec<String> {
        let text = |path: &Path| match path.to_str() {
            Some("src/lib.rs") => Some(root.to_owned()),
            Some("src/inner.rs") => Some(inner.to_owned()),
            _ => None,
        };
        list(Path::new("src/lib.rs"), "x", &text).unwrap().into_iter().collect()
    }

    #[test]
    fn public_items_are_listed_where_users_find_them() {
        assert_eq!(
            of(ROOT, INNER),
            [
                "x::Law.modulus: f64",
                "x::Law: impl std::fmt::Display for Law",
                "x::Law: struct, with private fields, derive(Clone, Debug), non_exhaustive",
                "x::Law::energy: fn energy(&self, c: &[f64; 6]) -> Result<f64, Error>",
                "x::Thing: use other_crate::Thing",
                "x::find: fn solve<T: Copy>(x: T) -> T",
                "x::open::SIZE: const usize",
            ]
        );
    }

    #[test]
    fn traits_say_what_an_implementor_has_to_write() {
        let found = of("mod inner; pub use inner::*;", INNER);
        for line in ["x::Part: trait", "x::Part::N: const usize", "x::Unseen: struct"] {
            assert!(found.contains(&line.to_owned()), "{line}: {found:?}");
        }
        assert!(found.contains(&"x::Part::name: required fn name(&self) -> &str".to_owned()), "{found:?}");
        assert!(found.contains(&"x::Part::mass: provided fn mass(&self) -> f64".to_owned()), "{found:?}");
    }

    #[test]
    fn a_changed_signature_is_another_line() {
        let changed = INNER.replace("&[f64; 6]", "&[f64; 9]");
        assert_eq!(of(ROOT, INNER).iter().filter(|line| !of(ROOT, &changed).contains(line)).count(), 1);
    }

    #[test]
    fn variants_have_their_fields() {
        let found = of("mod inner; pub use inner::E;", "pub enum E { A, B(u8, f64), C { at: usize } }");
        assert_eq!(found, ["x::E: enum", "x::E::A", "x::E::B(u8, f64)", "x::E::C { at: usize }"]);
    }
}
