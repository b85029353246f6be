//! The table of all rules for recipes.

use htex_base::finding::rule_table;

rule_table! {
    RECIPE_INVALID Error:
        "A recipe cannot be built.",
        "A key, a glob, a template, a plugin, an option or a gate in it is wrong, or a file that it names is not there.",
        "Correct what the message says; `htex build --dry-run` says then what would be fitted.";
}
