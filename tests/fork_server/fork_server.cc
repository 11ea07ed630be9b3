// fork_server: runs slipstick many times, its libraries loaded once. Binding the 350 000 symbols of deal.II and what it is
// linked to takes a process 0.3 s, more than most runs of the tests. Nothing of a run happens before its fork: MPI,
// OpenBLAS' buffers and all objects of slipstick are made in the child, as in a process of its own.
//
// Reads one request a line from standard input, a JSON object: "arguments" (of slipstick), "directory" (to run in), "stdout"
// and "stderr" (files to write), "memory" (limit of the address space in MB, 0: none). Answers with two lines: the process'
// number, a process group of its own, when it is started; when it has ended its exit status, or minus the signal that ended it.
#include <nlohmann/json.hpp>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

/// main() of source/app/main.cc, compiled under this name.
int slipstick_main(int argc, char **argv);

namespace
{
  constexpr int cannot_start = 125; // as env and timeout say that they could not start a command

  void redirect(const std::string &path, const int descriptor, const int flags)
  {
    const int file = open(path.c_str(), flags, 0600);
    if (file < 0 || dup2(file, descriptor) < 0)
      _exit(cannot_start);
    close(file);
  }

  [[noreturn]] void run(const nlohmann::json &request)
  {
    setsid();
    constexpr int writing = O_WRONLY | O_CREAT | O_TRUNC;
    redirect("/dev/null", STDIN_FILENO, O_RDONLY);
    redirect(request.at("stdout"), STDOUT_FILENO, writing);
    redirect(request.at("stderr"), STDERR_FILENO, writing);
    if (chdir(request.at("directory").get<std::string>().c_str()) != 0)
      _exit(cannot_start);
    if (const rlim_t megabytes = request.value("memory", 0); megabytes > 0)
      {
        const rlimit memory{megabytes << 20, megabytes << 20}, no_core{0, 0};
        setrlimit(RLIMIT_CORE, &no_core);
        setrlimit(RLIMIT_AS, &memory);
      }
    std::vector<std::string> words{"slipstick"};
    for (const auto &word : request.at("arguments"))
      words.push_back(word);
    std::vector<char *> argv;
    for (auto &word : words)
      argv.push_back(word.data());
    argv.push_back(nullptr);
    std::exit(slipstick_main(static_cast<int>(words.size()), argv.data()));
  }
} // namespace

int main()
{
  for (std::string line; std::getline(std::cin, line);)
    {
      const auto  request = nlohmann::json::parse(line);
      const pid_t child   = fork();
      if (child < 0)
        {
          std::perror("fork_server: fork");
          return 1;
        }
      if (child == 0)
        run(request);
      std::cout << child << std::endl;
      int status = 0;
      waitpid(child, &status, 0);
      std::cout << (WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status)) << std::endl;
    }
  return 0;
}
