#include "firmware-host/manual/bash_completion.h"

#include <algorithm>
#include <vector>

namespace pelorus {
namespace {

std::string joined(const std::vector<std::string>& words, const char* between) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : between) + word;
  return out;
}

std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

// CLI11 describes a choice as "{a,b}" or "{a->0,b->1}"; nothing else uses braces.
std::string choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t begin = type.find('{');
  const std::size_t end = type.find('}');
  if (begin == std::string::npos || end == std::string::npos) return "";
  std::vector<std::string> choices = CLI::detail::split(type.substr(begin + 1, end - begin - 1), ',');
  for (std::string& choice : choices) choice.erase(std::min(choice.find("->"), choice.size()));
  return joined(choices, " ");
}

bool takes_number(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  return type.starts_with("INT") || type.starts_with("UINT") || type.starts_with("FLOAT");
}

struct Cases {
  std::string verbs;   // patterns that lead deeper
  std::string words;   // verbs and options of each path
  std::string values;  // of options that take one
};

void add_parser(const CLI::App& parser, const std::string& path, Cases& cases) {
  std::vector<std::string> verbs;
  std::vector<std::string> options;
  for (const CLI::App* verb : parser.get_subcommands([](const CLI::App* v) { return !v->get_group().empty(); })) {
    verbs.push_back(verb->get_name());
    cases.verbs += (cases.verbs.empty() ? "" : " | ") + ("'" + path + " " + verb->get_name() + "'");
    add_parser(*verb, path + " " + verb->get_name(), cases);
  }
  for (const CLI::Option* option : parser.get_options()) {
    if (option->get_group().empty() || option->get_positional()) continue;
    const std::vector<std::string> names = names_of(*option);
    options.insert(options.end(), names.begin(), names.end());
    if (option->get_items_expected_max() == 0) continue;
    std::vector<std::string> patterns;
    for (const std::string& name : names) patterns.push_back("'" + path + ":" + name + "'");
    const std::string choices = choices_of(*option);
    std::string action = ":";  // a file
    if (!choices.empty()) action = "mapfile -t COMPREPLY < <(compgen -W '" + choices + "' -- \"$cur\")";
    if (choices.empty() && takes_number(*option)) action = "compopt +o default";
    cases.values += "    " + joined(patterns, " | ") + ") " + action + "; return ;;\n";
  }
  cases.words += "    '" + path + "') verbs='" + joined(verbs, " ") + "' options='" + joined(options, " ") + "' ;;\n";
}

}  // namespace

std::string bash_completion(const CLI::App& parser, const std::string& program) {
  Cases cases;
  add_parser(parser, "", cases);
  std::string out = "# Completion of " + program + " in bash. Made from the program's own command line.\n\n";
  out += "_" + program + "() {\n  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD - 1]}";
  out += " path='' verbs='' options=''\n  COMPREPLY=()\n";
  if (!cases.verbs.empty()) {
    out += "  local i\n  for ((i = 1; i < COMP_CWORD; i++)); do\n    case \"$path ${COMP_WORDS[i]}\" in\n      ";
    out += cases.verbs + ") path+=\" ${COMP_WORDS[i]}\" ;;\n    esac\n  done\n";
  }
  out += "  case \"$path\" in\n" + cases.words + "  esac\n";
  out += "  case \"$path:$prev\" in\n" + cases.values + "  esac\n";
  out += "  if [[ $cur == -* ]]; then\n    mapfile -t COMPREPLY < <(compgen -W \"$options\" -- \"$cur\")\n";
  out += "  elif [[ $verbs ]]; then\n    mapfile -t COMPREPLY < <(compgen -W \"$verbs\" -- \"$cur\")\n  fi\n}\n";
  return out + "complete -o default -F _" + program + " " + program + "\n";
}

}  // namespace pelorus
