#include "app/commands/manual.hpp"

#include <array>
#include <cctype>

#include "app/commands/help_text.hpp"

namespace sulcus {

namespace {

struct Note {
  const char *heading, *text;
};
constexpr std::array<Note, 3> kNotes{{
    {"Exit status",
     "0: done; 1: it failed while running; 2: bad usage or bad input, with one line that names the "
     "file, the place in it, what was found and what is expected."},
    {"Environment",
     "SULCUS_CACHE=DIR keeps what loading makes in another folder than ~/.cache/sulcus "
     "($XDG_CACHE_HOME/sulcus), SULCUS_CACHE=off nowhere. SULCUS_INSTRUCTIONS=plain does without "
     "AVX2 and AVX-512, SULCUS_INSTRUCTIONS=avx2 without AVX-512, to the same bits."},
    {"Programs", "Charts (forces.png) are drawn by gnuplot, videos written by ffmpeg."},
}};

/// Text for roff: nothing in it is a command.
std::string roff(const std::string& text) {
  std::string out;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
    line_begins = c == '\n';
  }
  return out;
}

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::string title(const std::string& name, int section, const std::string& what) {
  std::string page = ".TH ";
  page.append(roff(upper(name))).append(" ").append(std::to_string(section));
  page.append(" \"\" Sulcus\n.SH NAME\n");
  return page.append(roff(name)).append(" \\- ").append(roff(what)).append("\n");
}

void section(std::string& page, const std::string& heading) {
  page.append(".SH ").append(roff(upper(heading))).append("\n");
}

void item(std::string& page, const std::string& tag, const std::string& text) {
  page.append(".TP\n.B ").append(roff(tag)).append("\n").append(roff(text)).append("\n");
}

void notes(std::string& page) {
  for (const Note& note : kNotes) {
    section(page, note.heading);
    page.append(roff(note.text)).append("\n");
  }
}

/// A flag takes none.
bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

/// "--camera CAMERA", or "SCENE".
std::string tag_of(const CLI::Option& option) {
  if (option.get_positional()) return option.get_name(true);
  std::string tag;
  for (const std::string& name : option.get_snames()) tag.append(tag.empty() ? "-" : ", -") += name;
  for (const std::string& name : option.get_lnames()) {
    tag.append(tag.empty() ? "--" : ", --") += name;
  }
  if (takes_value(option)) tag.append(" ") += option.get_type_name();
  return tag;
}

/// The words between the braces that a choice has in its type; empty: no choice.
std::string words_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{'), close = type.rfind('}');
  if (open == std::string::npos || close == std::string::npos) return {};
  std::string words = type.substr(open + 1, close - open - 1);
  for (char& c : words) c = c == ',' ? ' ' : c;
  return words;
}

/// How bash completes the value of an option.
std::string completion_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  if (const std::string words = words_of(option); !words.empty()) return "words \"" + words + '"';
  if (type == "FILE") return "files";
  if (type == "DIR") return "folders";
  if (type.starts_with("TABLE.KEY")) return "keys";
  return "nothing";
}

/// "--a" and "-a" of an option.
std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

}  // namespace

std::string program_footer() {
  std::string text =
      "'sulcus COMMAND --help' lists the options of a command, 'sulcus help scene' every key of a "
      "scene, 'sulcus help recording' all that a recording holds.\n";
  for (const Note& note : kNotes) {
    text.append(note.heading).append(": ").append(wrapped(note.text, 2, 98)).append("\n");
  }
  return text;
}

std::string program_page(const CLI::App& program) {
  std::string page = title("sulcus", 1, "real-time dental cutting simulator");
  section(page, "Synopsis");
  page.append(".B sulcus\n.I COMMAND\n[options]\n");
  section(page, "Commands");
  for (const CLI::App* command : program.get_subcommands({})) {
    item(page, command->get_name(), command->get_description());
  }
  section(page, "Options");
  for (const CLI::Option* option : program.get_options()) {
    item(page, tag_of(*option), option->get_description());
  }
  notes(page);
  section(page, "See also");
  for (const CLI::App* command : program.get_subcommands({})) {
    page.append(".BR ").append(roff("sulcus-" + command->get_name())).append(" (1),\n");
  }
  return page.append(".BR sulcus\\-scene (5),\n.BR sulcus\\-recording (5)\n");
}

std::string command_page(const CLI::App& command) {
  std::string page = title("sulcus-" + command.get_name(), 1, command.get_description());
  section(page, "Synopsis");
  page.append(".B sulcus ").append(roff(command.get_name())).append("\n[options]");
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_positional()) continue;
    const std::string name = option->get_name(true);
    page.append("\n.I ").append(option->get_required() ? name : "[" + name + "]");
  }
  page += '\n';
  section(page, "Options");
  for (const CLI::Option* option : command.get_options()) {
    std::string text = option->get_description();
    if (!option->get_positional() && option->get_required()) text += ". Must be given.";
    item(page, tag_of(*option), text);
  }
  notes(page);
  section(page, "See also");
  return page.append(".BR sulcus (1),\n.BR sulcus\\-scene (5),\n.BR sulcus\\-recording (5)\n");
}

std::string scene_page() {
  std::string page = title("sulcus-scene", 5, "a scene of sulcus, as TOML");
  section(page, "Description");
  page.append(
      "What a scene does not name is not modelled, allocated or timed. Only [workpiece] and\n"
      "[trajectory] must be there. Brackets at the end of a line name a source.\n");
  for (const SceneTableKeys& table : scene_tables()) {
    page.append(".SH ").append(roff(heading_of(table))).append("\n");
    page.append(roff(text_of(table))).append("\n");
    for (const SceneKey& key : table.keys) {
      const KeyHelp help = help_of(key);
      item(page, help.key, help.values);
      page.append(".br\n").append(roff(help.what)).append("\n");
    }
  }
  section(page, "See also");
  return page.append(".BR sulcus (1)\n");
}

std::string recording_page() {
  std::string page = title("sulcus-recording", 5, "a recording of sulcus, in HDF5");
  section(page, "Description");
  page.append(roff(recording_notes())).append("\n");
  page.append(".PP\n.nf\n").append(roff(recording_examples())).append(".fi\n");
  for (const StoredPart& part : recording_layout()) {
    page.append(".SH ").append(roff(std::string(part.path))).append("\n");
    page.append(roff(text_of(part))).append("\n");
    for (const StoredField& field : part.fields) {
      const std::string values = values_of(field), what(field.what);
      if (field.name.empty()) {
        page.append(".PP\n").append(roff(values + ": " + what)).append("\n");
      } else {
        item(page, std::string(field.name), values);
        page.append(".br\n").append(roff(what)).append("\n");
      }
    }
  }
  section(page, "See also");
  return page.append(".BR sulcus (1),\n.BR sulcus\\-scene (5)\n");
}

std::string bash_completion(const CLI::App& program) {
  std::string commands, cases, options;
  for (const CLI::App* command : program.get_subcommands({})) {
    const std::string name = command->get_name();
    commands.append(name) += ' ';
    std::string own;
    for (const CLI::Option* option : command->get_options()) {
      for (const std::string& word : names_of(*option)) {
        own.append(word) += ' ';
        if (!takes_value(*option)) continue;
        cases.append("    \"").append(name).append(" ").append(word).append("\") _sulcus_");
        cases.append(completion_of(*option)).append(" ;;\n");
      }
    }
    options.append("        ").append(name).append(") _sulcus_words \"");
    options.append(own).append("\" ;;\n");
    for (const CLI::Option* option : command->get_options()) {
      if (!option->get_positional() || words_of(*option).empty()) continue;
      cases.append("    \"").append(name).append(" ").append(name).append("\") _sulcus_");
      cases.append(completion_of(*option)).append(" ;;\n");
    }
  }
  std::string keys;
  for (const std::string& key : keys_to_set()) keys.append(key) += "= ";
  return "# Completion of sulcus for bash, made by the program itself.\n"
         "_sulcus_words() { mapfile -t COMPREPLY < <(compgen -W \"$1\" -- \"$word\"); }\n"
         "_sulcus_files() { compopt -o filenames; "
         "mapfile -t COMPREPLY < <(compgen -f -- \"$word\"); }\n"
         "_sulcus_folders() { compopt -o filenames; "
         "mapfile -t COMPREPLY < <(compgen -d -- \"$word\"); }\n"
         "_sulcus_keys() {\n  compopt -o nospace\n  _sulcus_words \"" +
         keys +
         "\"\n}\n"
         "_sulcus_nothing() { COMPREPLY=(); }\n"
         "_sulcus() {\n"
         "  local word=${COMP_WORDS[COMP_CWORD]} command=${COMP_WORDS[1]}\n"
         "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
         "    _sulcus_words \"" +
         commands +
         "--help --version\"\n"
         "    return\n"
         "  fi\n"
         "  case \"$command ${COMP_WORDS[COMP_CWORD - 1]}\" in\n" +
         cases +
         "    *)\n"
         "      if [[ $word != -* ]]; then _sulcus_files; return; fi\n"
         "      case \"$command\" in\n" +
         options +
         "      esac ;;\n"
         "  esac\n"
         "}\n"
         "complete -F _sulcus sulcus\n";
}

}  // namespace sulcus
