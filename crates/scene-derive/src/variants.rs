//! An enumeration of tables that a key tells apart.

use crate::options::Options;
use crate::structure::context;
use proc_macro2::TokenStream;
use quote::quote;
use syn::{Data, DeriveInput, Fields, Ident};

/// The enumeration, the names of its variants, and its reader.
pub(crate) fn expand(arguments: &Options, mut input: DeriveInput) -> syn::Result<TokenStream> {
    arguments.only(&["example", "tag"], &["context"])?;
    let Some(tag) = arguments.text("tag")? else {
        return Err(syn::Error::new_spanned(
            &input.ident,
            "an enumeration of tables has a key for its variants: tag = \"...\"",
        ));
    };
    let Data::Enum(data) = &mut input.data else { unreachable!("called for enumerations alone") };
    let (mut idents, mut names, mut types) = (Vec::new(), Vec::new(), Vec::new());
    for variant in &mut data.variants {
        let options = Options::take(&mut variant.attrs)?;
        options.only(&["name"], &[])?;
        let ty = match &variant.fields {
            Fields::Unnamed(fields) if fields.unnamed.len() == 1 => fields.unnamed[0].ty.clone(),
            _ => return Err(syn::Error::new_spanned(variant, "a variant holds one table")),
        };
        types.push(ty);
        let name = options.text("name")?.unwrap_or_else(|| kebab(&variant.ident));
        variant.attrs.push(syn::parse_quote!(#[serde(rename = #name)]));
        idents.push(variant.ident.clone());
        names.push(name);
    }
    let (name, visibility, attributes, variants) = (&input.ident, &input.vis, &input.attrs, &data.variants);
    let (generic, context) = context(arguments)?;
    let first = names.first().map_or_else(String::new, |name| format!("{tag} = \"{name}\""));
    let example = arguments.text("example")?.unwrap_or_else(|| format!("{{ {first} }}"));
    Ok(quote! {
        #[derive(Clone, Debug, PartialEq, ::serde::Serialize)]
        #[cfg_attr(feature = "schema", derive(::schemars::JsonSchema))]
        #[serde(tag = #tag, deny_unknown_fields)]
        #(#attributes)*
        #visibility enum #name { #variants }

        impl #name {
            /// Names of the variants, in their order.
            pub const NAMES: &'static [&'static str] = &[#(#names),*];

            /// Name of the variant.
            pub fn name(&self) -> &'static str {
                match self { #(Self::#idents(_) => #names,)* }
            }
        }

        impl #name {
            /// Reads the table and reports what is wrong with it.
            pub(crate) fn from_table #generic(table: &crate::read::Table<'_>, context: &#context) -> Option<Self> {
                let chosen = table.required(#tag, #first, |node| {
                    node.choice(Self::NAMES, |name| Self::NAMES.iter().copied().find(|known| *known == name))
                });
                // Without it, it is not known which other keys are right.
                match chosen? {
                    #(#names => <#types>::from_table(table, context).map(Self::#idents),)*
                    _ => None,
                }
            }
        }

        impl #generic crate::read::Value<#context> for #name {
            fn read(node: &crate::read::Node<'_>, context: &#context) -> Option<Self> {
                let table = node.table_like(#example)?;
                Self::from_table(&table, context)
            }
        }
    })
}

/// Name of a variant in a scene: `HollowBall` is `hollow-ball`.
fn kebab(ident: &Ident) -> String {
    let mut name = String::new();
    for letter in ident.to_string().chars() {
        if letter.is_uppercase() && !name.is_empty() {
            name.push('-');
        }
        name.extend(letter.to_lowercase());
    }
    name
}
