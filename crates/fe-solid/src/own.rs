//! Which elements of a body have data here, and their numbers in the body. Not the data.

use std::sync::Arc;
use stoss_mesh::Elements;

/// The elements of which a body has data.
#[derive(Clone, Debug)]
pub(crate) struct Own {
    /// Elements with global nodes, counted from 0.
    pub elements: Arc<Elements>,
    /// Number of each in the body, ascending; nothing where a body was never shared out.
    numbers: Option<Arc<[u32]>>,
}

impl Own {
    /// All elements of a body.
    pub fn all(elements: &Arc<Elements>) -> Self {
        Self { elements: Arc::clone(elements), numbers: None }
    }

    /// The flagged elements of a body.
    pub fn flagged(all: &Elements, mine: &[bool]) -> Self {
        let (mut elements, mut numbers) = (Elements::new(), Vec::new());
        for (element, (kind, nodes)) in all.cells().enumerate().filter(|(element, _)| mine[*element]) {
            elements.push(kind, nodes);
            numbers.push(element as u32);
        }
        Self { elements: Arc::new(elements), numbers: Some(numbers.into()) }
    }

    /// The number in the body of an element.
    pub fn number(&self, own: usize) -> usize {
        self.numbers.as_ref().map_or(own, |numbers| numbers[own] as usize)
    }

    /// Where an element of the body is among these; nothing if it is not.
    pub fn place(&self, element: usize) -> Option<usize> {
        match &self.numbers {
            None => Some(element),
            Some(numbers) => numbers.binary_search(&(element as u32)).ok(),
        }
    }

    /// Whether the body was shared out.
    pub fn is_share(&self) -> bool {
        self.numbers.is_some()
    }

    /// Heap memory in bytes, beside that of the body's elements.
    pub fn memory_bytes(&self) -> usize {
        let of = |numbers: &Arc<[u32]>| {
            let nodes: usize = self.elements.blocks().iter().map(|cells| size_of_val(cells.nodes())).sum();
            nodes + size_of_val(&**numbers)
        };
        self.numbers.as_ref().map_or(0, of)
    }
}
