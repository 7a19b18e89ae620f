//! What a field of a table can be.

use super::node::Node;

/// A type whose values stand in a scene. `C` is what its reader must know beside the document.
pub(crate) trait Value<C>: Sized {
    /// The value; reports what is wrong with it.
    fn read(node: &Node<'_>, context: &C) -> Option<Self>;
}

macro_rules! plain {
    ($($type:ty: $reader:path),+ $(,)?) => {
        $(impl<C> Value<C> for $type {
            fn read(node: &Node<'_>, _: &C) -> Option<Self> {
                $reader(node)
            }
        })+
    };
}

plain! {
    f64: Node::number,
    bool: Node::boolean,
    u32: Node::count,
    usize: count,
    String: Node::text,
}

fn count(node: &Node<'_>) -> Option<usize> {
    node.count().map(|count| count as usize)
}

/// The value that a reader finds; closures learn the types of their arguments here.
pub(crate) fn alone<'a, T>(read: impl FnOnce(&Node<'a>) -> Option<T>, node: &Node<'a>) -> Option<T> {
    read(node)
}

/// The value as of [`alone`], of a reader that asks for the context.
pub(crate) fn beside<'a, C, T>(
    read: impl FnOnce(&Node<'a>, &C) -> Option<T>,
    node: &Node<'a>,
    context: &C,
) -> Option<T> {
    read(node, context)
}

/// The value as of [`beside`], of a reader that also asks for the keys that were read before.
pub(crate) fn among<'a, C, K, T>(
    read: impl FnOnce(&Node<'a>, &C, &K) -> Option<T>,
    node: &Node<'a>,
    context: &C,
    keys: &K,
) -> Option<T> {
    read(node, context, keys)
}

/// What there can be too many of, if the numbers of divisions are a mistake.
#[derive(Clone, Copy)]
pub(crate) struct Limit {
    pub(crate) noun: &'static str,
    pub(crate) most: f64,
}

impl Limit {
    /// Reports that there are too many.
    pub(crate) fn keep(self, node: &Node<'_>, made: f64) -> Option<()> {
        let Self { noun, most } = self;
        if made > most {
            return node.fail(format!("gives {made:.1e} {noun}"), format!("at most {most:.0e} are possible"));
        }
        Some(())
    }
}

/// Numbers of divisions, each at least its minimum, of which `total` makes a mesh or surface.
pub(crate) fn divisions<T: TryFrom<u32>, const N: usize>(
    node: &Node<'_>,
    minima: [u32; N],
    total: impl Fn([f64; N]) -> f64,
    limit: Limit,
) -> Option<[T; N]> {
    let counts: [u32; N] = node.array(Node::count)?;
    if let Some(i) = (0..N).find(|&i| counts[i] < minima[i]) {
        return node.fail(format!("entry {} must be at least {}", i + 1, minima[i]), "use more divisions");
    }
    limit.keep(node, total(counts.map(f64::from)))?;
    let converted: Vec<T> = counts.into_iter().filter_map(|count| T::try_from(count).ok()).collect();
    converted.try_into().ok()
}
