// What main() of the two programs is. Their headers stay light: CLI11's cost more to compile than all else here.
#pragma once

namespace tessera {

// `tessera`: the verbs that need the codec and pictures, but no scene, GPU or server. For all else, and for every
// misuse, it goes on as `tessera-full` with the same arguments: the program beside this one, or where both are
// installed.
int quick_program(int argc, char** argv);

// `tessera-full`: all of the tool.
int full_program(int argc, char** argv);

} // namespace tessera
