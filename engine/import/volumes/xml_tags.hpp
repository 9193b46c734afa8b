#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace sulcus {

/// A tag that opens an element of an XML text.
struct XmlTag {
  std::string name;                               // without the prefix of its namespace
  std::map<std::string, std::string> attributes;  // references resolved, blanks for white space

  /// Empty where there is none.
  std::string at(const std::string& attribute) const {
    const auto found = attributes.find(attribute);
    return found == attributes.end() ? std::string() : found->second;
  }
};

/// The tags that open elements, in the order of the text [XML 1.0]: not those within comments and
/// character data. `whole`: false where a tag, a comment or another part breaks off, or is none;
/// `tags` are those before it.
struct XmlTags {
  std::vector<XmlTag> tags;
  bool whole = true;
};
XmlTags xml_tags(std::string_view text);

}  // namespace sulcus
