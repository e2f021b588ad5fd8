#include "clients/visum/common/completion.h"

namespace visum::cli {
namespace {

// In single quotes, for any of the three shells.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

std::string option_words(const Shell::Command& command) {
  std::string words;
  for (const auto& option : command.options) words += (words.empty() ? "" : " ") + option.name;
  return words;
}

std::string command_words(const std::vector<Shell::Command>& commands) {
  std::string words;
  for (const auto& command : commands) words += (words.empty() ? "" : " ") + command.name;
  return words;
}

// Candidates with blanks ("Actual Angle 1") are escaped, unless the user has opened a quote. Where there are
// none bash offers files.
constexpr const char* kBashHead = R"(_visum_candidates() {
  local cur="$1" quote=''
  case "$cur" in [\'\"]*) quote=1; cur="${cur:1}" ;; esac
  cur="${cur//\\/}"
  local line
  while IFS= read -r line; do
    [[ "$line" == "$cur"* ]] || continue
    if [[ -n "$quote" ]]; then COMPREPLY+=("$line"); else COMPREPLY+=("${line// /\\ }"); fi
  done
}
_visum() {
  local cur="${COMP_WORDS[COMP_CWORD]}" verb='' part='' count=0 link=() i
  COMPREPLY=()
  for ((i = 1; i < COMP_CWORD; i++)); do
    case "${COMP_WORDS[i]}" in
      --connect|--token-file|--tls-ca|--tls-cert|--tls-key)
        link+=("${COMP_WORDS[i]}" "${COMP_WORDS[i+1]}"); i=$((i + 1)) ;;
      -*) ;;
      *) if [[ -z "$verb" ]]; then verb="${COMP_WORDS[i]}"; else part="${part:-${COMP_WORDS[i]}}"; count=$((count + 1)); fi ;;
    esac
  done
  if [[ -z "$verb" ]]; then
)";
constexpr const char* kBashTail = R"(    esac
    return
  fi
  case "$verb" in
    completion) COMPREPLY=($(compgen -W 'bash zsh fish' -- "$cur")) ;;
    get|set|watch|describe|params|param-set|fault|faults)
      if ((count == 0)); then
        _visum_candidates "$cur" < <(visum parts --names "${link[@]}" 2>/dev/null)
      elif [[ "$verb" == get || "$verb" == set || "$verb" == watch ]]; then
        _visum_candidates "$cur" < <(visum describe "$part" --names "${link[@]}" 2>/dev/null)
      fi ;;
  esac
}
complete -o default -F _visum visum
)";

constexpr const char* kZshTail = R"(    esac
    return
  fi
  local -a names
  case $words[2] in
    run|check|drives|convert|record|replay|rewind|export|mirror|exec) _files ;;
    completion) compadd bash zsh fish ;;
    get|set|watch|describe|params|param-set|fault|faults)
      if (( CURRENT == 3 )); then
        names=("${(@f)$(visum parts --names 2>/dev/null)}")
        compadd -a names
      elif [[ $words[2] == (get|set|watch) ]]; then
        names=("${(@f)$(visum describe "$words[3]" --names 2>/dev/null)}")
        compadd -a names
      fi ;;
  esac
}
# Found in $fpath this file is _visum itself; sourced, it must make itself known.
if [[ ${funcstack[1]} == _visum ]]; then
  _visum "$@"
else
  (( $+functions[compdef] )) || { autoload -Uz compinit && compinit; }
  compdef _visum visum
fi
)";

}  // namespace

std::string Shell::bash() const {
  std::string script = kBashHead;
  script +=
      "    COMPREPLY=($(compgen -W " + quoted(command_words(commands)) + " -- \"$cur\"))\n    return\n  fi\n";
  script += "  if [[ \"$cur\" == -* ]]; then\n    case \"$verb\" in\n";
  for (const Command& command : commands) {
    script += "      " + command.name + ") COMPREPLY=($(compgen -W " + quoted(option_words(command)) +
              " -- \"$cur\")) ;;\n";
  }
  return script + kBashTail;
}

std::string Shell::zsh() const {
  std::string script = "#compdef visum\n_visum() {\n  local -a verbs\n  verbs=(\n";
  for (const Command& command : commands) script += "    " + quoted(command.name + ":" + command.help) + "\n";
  script += "  )\n  if (( CURRENT == 2 )); then _describe verb verbs; return; fi\n";
  script += "  if [[ $PREFIX == -* ]]; then\n    case $words[2] in\n";
  for (const Command& command : commands) {
    script += "      " + command.name + ") compadd -- " + option_words(command) + " ;;\n";
  }
  return script + kZshTail;
}

std::string Shell::fish() const {
  std::string script = "complete -c visum -f\n";
  for (const Command& command : commands) {
    script += "complete -c visum -n __fish_use_subcommand -a " + command.name + " -d " +
              quoted(command.help) + "\n";
    for (const Option& option : command.options) {
      script += "complete -c visum -n '__fish_seen_subcommand_from " + command.name + "' -l " +
                option.name.substr(2) + " -d " + quoted(option.help) + "\n";
    }
  }
  script +=
      "complete -c visum -n '__fish_seen_subcommand_from run check drives convert record replay rewind "
      "export "
      "mirror exec' -F\n";
  script += "complete -c visum -n '__fish_seen_subcommand_from completion' -a 'bash zsh fish'\n";
  script +=
      "complete -c visum -n '__fish_seen_subcommand_from get set watch describe params param-set fault "
      "faults' "
      "-a '(visum parts --names 2>/dev/null)'\n";
  script +=
      "complete -c visum -n '__fish_seen_subcommand_from get set watch; and test (count (commandline -opc)) "
      "-gt 2' "
      "-a '(visum describe (commandline -opc)[3] --names 2>/dev/null)'\n";
  return script;
}

}  // namespace visum::cli
