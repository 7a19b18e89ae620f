//! A struct: one field a key.

use crate::options::Options;
use proc_macro2::TokenStream;
use quote::{format_ident, quote};
use syn::{Data, DeriveInput, Field, Fields, GenericArgument, Ident, PathArguments, Type};

const FLAGS: &[&str] = &["auto", "default", "skip", "tables"];
const OPTIONS: &[&str] = &["name", "default", "example", "dimension", "range", "read", "with", "by"];

/// What the macro writes for one field.
struct Key {
    /// The field with the attributes of `serde` and `schemars`.
    field: TokenStream,
    /// Functions of the type: the default, and whether a value is it.
    functions: TokenStream,
    /// The field of the keys that were read so far.
    partial: TokenStream,
    /// Reading it.
    read: TokenStream,
    /// The field from the keys.
    build: TokenStream,
    /// The field if the key is left out, which a required one cannot be.
    left_out: Option<TokenStream>,
}

/// The struct, its keys, and its reader.
pub(crate) fn expand(arguments: &Options, mut input: DeriveInput) -> syn::Result<TokenStream> {
    arguments.only(&["example", "check", "check_all"], &["context"])?;
    let Data::Struct(data) = &mut input.data else { unreachable!("called for structs alone") };
    let Fields::Named(fields) = &mut data.fields else {
        return Err(syn::Error::new_spanned(&input.ident, "a table has named fields"));
    };
    let (name, visibility, attributes) = (&input.ident, &input.vis, &input.attrs);
    let keys = fields.named.iter_mut().map(|field| key(name, field)).collect::<syn::Result<Vec<_>>>()?;
    let each = |of: fn(&Key) -> &TokenStream| keys.iter().map(of).cloned().collect::<TokenStream>();
    let (field, functions, partial) = (each(|k| &k.field), each(|k| &k.functions), each(|k| &k.partial));
    let (read, build) = (each(|k| &k.read), each(|k| &k.build));
    let left_out = keys.iter().map(|key| key.left_out.clone()).collect::<Option<TokenStream>>();
    let default = left_out.map(|fields| {
        quote! {
            impl Default for #name {
                fn default() -> Self {
                    Self { #fields }
                }
            }
        }
    });

    let partial_name = format_ident!("{name}Keys");
    let (generic, context) = context(arguments)?;
    let check = arguments.value("check").map(|path| quote!(let fits = (#path)(&keys, table, context);));
    let fits = arguments.value("check").map(|_| quote!(fits?;));
    let check_all = arguments.value("check_all").map(|path| quote!((#path)(&value, table, context)?;));
    let example = arguments.text("example")?.unwrap_or_else(|| "{ key = value }".to_owned());
    let about = format!("Keys of [`{name}`] that were read so far, each `None` if it is wrong or missing.");
    Ok(quote! {
        #[derive(Clone, Debug, PartialEq, ::serde::Serialize)]
        #[cfg_attr(feature = "schema", derive(::schemars::JsonSchema))]
        #[serde(deny_unknown_fields)]
        #(#attributes)*
        #visibility struct #name { #field }

        impl #name { #functions }

        #default

        #[doc = #about]
        #[derive(Default)]
        #[allow(dead_code, reason = "not every table has a check that looks at each key")]
        pub(crate) struct #partial_name { #partial }

        impl #partial_name {
            /// Reads every key; what no key asked for is still to be reported.
            #[allow(unused_variables, reason = "not every table has keys that depend on the context")]
            pub(crate) fn read #generic(table: &crate::read::Table<'_>, context: &#context) -> Self {
                let mut keys = Self::default();
                #read
                keys
            }

            /// The table, if all keys are right.
            pub(crate) fn build(self) -> Option<#name> {
                Some(#name { #build })
            }
        }

        impl #name {
            /// Reads the table and reports what is wrong with it.
            pub(crate) fn from_table #generic(table: &crate::read::Table<'_>, context: &#context) -> Option<Self> {
                let keys = #partial_name::read(table, context);
                #check
                table.finish();
                #fits
                let value = keys.build()?;
                #check_all
                Some(value)
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

/// Generic parameters of the reader, and the type of its context.
pub(crate) fn context(arguments: &Options) -> syn::Result<(TokenStream, TokenStream)> {
    Ok(match arguments.ty("context")? {
        Some(context) => (TokenStream::new(), quote!(#context)),
        None => (quote!(<C>), quote!(C)),
    })
}

fn key(owner: &Ident, field: &mut Field) -> syn::Result<Key> {
    let options = Options::take(&mut field.attrs)?;
    options.only(OPTIONS, &[])?;
    let Some(ident) = field.ident.clone() else { unreachable!("fields have names") };
    let (attributes, visibility, ty) = (&field.attrs, &field.vis, &field.ty);
    let name = options.text("name")?.unwrap_or_else(|| ident.to_string());
    let optional = inner(ty, "Option");
    let value = optional.unwrap_or(ty);
    if options.has("tables") {
        let Some(of) = inner(ty, "Vec") else { return Err(syn::Error::new_spanned(ty, "tables are a `Vec`")) };
        let rename = options.text("name")?.map(|name| quote!(#[serde(rename = #name)]));
        return Ok(Key {
            field: quote!(#(#attributes)* #[serde(default, skip_serializing_if = "Vec::is_empty")] #rename #visibility #ident: #ty,),
            functions: TokenStream::new(),
            partial: quote!(pub(crate) #ident: Option<#ty>,),
            read: quote! {
                keys.#ident = table.tables(#name).iter().map(|table| <#of>::from_table(table.as_ref()?, context)).collect();
            },
            build: quote!(#ident: self.#ident?,),
            left_out: Some(quote!(#ident: Vec::new(),)),
        });
    }
    let options_of_reader = ["read", "with", "by", "range"].map(|name| options.value(name));
    let named = options.reader(FLAGS)?;
    let readers = options_of_reader.iter().flatten().count() + usize::from(named.is_some());
    if readers > 1 {
        return Err(syn::Error::new_spanned(
            &ident,
            "a key has one reader: one of read, with, by, range, or the name of one",
        ));
    }
    let read = match options_of_reader {
        [Some(path), ..] => quote!(crate::read::alone(#path, node)),
        [_, Some(path), ..] => quote!(crate::read::among(#path, node, context, &keys)),
        [_, _, Some(path), _] => reader(value, &quote!(crate::read::beside(#path, node, context)), false),
        [.., Some(range)] => quote!(node.whole_within(#range)),
        _ => match named {
            Some(name) => reader(value, &quote!(node.#name()), name == "direction"),
            None => reader(value, &quote!(crate::read::Value::read(node, context)), false),
        },
    };
    let reader = quote!(|node| #read);
    let rename = options.text("name")?.map(|name| quote!(#[serde(rename = #name)]));
    let dimension = options.dimension();
    let mut functions = TokenStream::new();
    let mut left_out = None;
    let (serde, read) = if optional.is_some() {
        left_out = Some(quote!(#ident: None,));
        let read = if options.has("auto") {
            quote!(table.optional(#name, |node| if node.is_auto() { Some(None) } else { #read.map(Some) }).map(Option::flatten))
        } else {
            quote!(table.optional(#name, #reader))
        };
        (quote!(#[serde(default, skip_serializing_if = "Option::is_none")]), read)
    } else if let Some(default) = default(&options) {
        let function = format_ident!("default_{ident}");
        left_out = Some(quote!(#ident: Self::#function(),));
        let is_default = format_ident!("is_default_{ident}");
        let path = format!("{owner}::{function}");
        let about = format!("Value of `{name}` if it is left out.");
        functions.extend(quote! {
            #[doc = #about]
            pub(crate) fn #function() -> #ty { #default }
        });
        let skip = options.has("skip").then(|| {
            let path = format!("{owner}::{is_default}");
            functions.extend(quote! {
                fn #is_default(value: &#ty) -> bool { *value == Self::#function() }
            });
            quote!(#[serde(skip_serializing_if = #path)])
        });
        (quote!(#[serde(default = #path)] #skip), quote!(table.default(#name, #owner::#function(), #reader)))
    } else {
        let Some(example) = options.text("example")? else {
            return Err(syn::Error::new_spanned(&ident, "a required key has an example: #[key(example = \"...\")]"));
        };
        let example = format!("{name} = {example}");
        (TokenStream::new(), quote!(table.required(#name, #example, #reader)))
    };
    Ok(Key {
        field: quote!(#(#attributes)* #serde #rename #dimension #visibility #ident: #ty,),
        functions,
        partial: quote!(pub(crate) #ident: Option<#ty>,),
        read: quote!(keys.#ident = #read;),
        build: quote!(#ident: self.#ident?,),
        left_out,
    })
}

/// Expression of the default, if the key has one.
fn default(options: &Options) -> Option<TokenStream> {
    match options.value("default") {
        Some(value) => Some(quote!(#value)),
        None => options.has("default").then(|| quote!(Default::default())),
    }
}

/// Expression that reads a value of the type from `node`, each of its elements by `element`. `vector`: an array of numbers is one element.
fn reader(ty: &Type, element: &TokenStream, vector: bool) -> TokenStream {
    if let Some(of) = inner(ty, "Vec") {
        let read = reader(of, element, vector);
        return quote!(node.list(|node| #read));
    }
    match ty {
        Type::Array(array) if !(vector && is_number(&array.elem)) => {
            let read = reader(&array.elem, element, vector);
            quote!(node.array(|node| #read))
        }
        _ => element.clone(),
    }
}

fn is_number(ty: &Type) -> bool {
    matches!(ty, Type::Path(path) if path.path.is_ident("f64"))
}

/// The type in the brackets of `outer<...>`.
fn inner<'a>(ty: &'a Type, outer: &str) -> Option<&'a Type> {
    let Type::Path(path) = ty else { return None };
    let segment = path.path.segments.last().filter(|segment| segment.ident == outer)?;
    match &segment.arguments {
        PathArguments::AngleBracketed(arguments) => match arguments.args.first() {
            Some(GenericArgument::Type(ty)) => Some(ty),
            _ => None,
        },
        _ => None,
    }
}
