#pragma once

#include <string>

#include <toml++/toml.h>

namespace sulcus {

/// Applies one `--set TABLE.KEY=VALUE` to a scene: the value is read as TOML, else taken as a
/// string; tables that are not there are made; `tissue.NAME.KEY` addresses a [[tissue]] by its
/// name, and a workpiece's file takes the place of its shape. The nodes carry that they came from
/// --set (kFromOverride). InputError for what is none; whether a key is known is found when the
/// scene is read.
void apply_override(toml::table& root, const std::string& text);

}  // namespace sulcus
