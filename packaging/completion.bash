# Completion of slipstick(1) for bash: options, scenes, and after --set the parameters that the scene sets.
# shellcheck shell=bash

# Section/Name of every "set" in a .prm, one a line.
_slipstick_parameters() {
  awk '{ sub(/#.*/, "") }
    $1 == "subsection" { sub(/^[ \t]*subsection[ \t]+/, ""); sub(/[ \t]+$/, ""); path[++depth] = $0; next }
    $1 == "end" { if (depth) --depth; next }
    $1 == "set" && /=/ {
      sub(/^[ \t]*set[ \t]+/, ""); sub(/[ \t]*=.*/, "")
      name = ""
      for (i = 1; i <= depth; ++i) name = name path[i] "/"
      print name $0 "="
    }' "$1" 2>/dev/null
}

_slipstick() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} word
  local IFS=$'\n'
  COMPREPLY=()
  case $previous in
    --set)
      compopt -o nospace 2>/dev/null
      for word in "${COMP_WORDS[@]}"; do
        [[ $word == *.prm && -r $word ]] || continue
        current=${current#[\"\']}
        mapfile -t COMPREPLY < <(_slipstick_parameters "$word" | awk -v start="$current" 'index($0, start) == 1')
        [[ ${#COMPREPLY[@]} -eq 0 ]] || mapfile -t COMPREPLY < <(printf '%q\n' "${COMPREPLY[@]}")
        return
      done
      ;;
    --new)
      mapfile -t COMPREPLY < <(compgen -W "$(slipstick --help 2>/dev/null | tr '\n' ' ' | sed -n 's/.*start from: *\([a-z_, ]*[a-z_]\).*/\1/p' | tr ', ' '\n')" -- "$current")
      ;;
    --output) mapfile -t COMPREPLY < <(compgen -d -- "$current") ;;
    --list-parameters) mapfile -t COMPREPLY < <(compgen -W $'text\nprm\njson\nlatex' -- "$current") ;;
    *)
      if [[ $current == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$(slipstick --help 2>/dev/null | grep -oE -- '--[a-z][a-z-]*' | sort -u)" -- "$current")
      else
        compopt -o filenames 2>/dev/null
        mapfile -t COMPREPLY < <(compgen -f -X '!*.prm' -- "$current"; compgen -d -- "$current")
      fi
      ;;
  esac
}
complete -F _slipstick slipstick
