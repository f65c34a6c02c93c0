/* Opens a file so that no other process may use it, says so, and waits for its end.
 *   hold_file NAME */
#include <stdio.h>
#include <windows.h>

int main(int argc, char** argv) {
    const HANDLE held = argc > 1 ? CreateFileA(argv[1], GENERIC_READ, 0, NULL, OPEN_EXISTING,
                                               FILE_ATTRIBUTE_NORMAL, NULL)
                                 : INVALID_HANDLE_VALUE;
    if (held == INVALID_HANDLE_VALUE)
        return 1;
    puts("held");
    fflush(stdout);
    Sleep(60000);
    return 0;
}
