// fork_server SOCKET: starts runs of slipstick whose libraries are loaded already. Binding the 350 000 symbols of deal.II and
// what it is linked to takes a process 0.3 s, more than most runs of the tests. Nothing of a run happens before its fork:
// MPI, OpenBLAS' buffers and all objects of slipstick are made in the child, as in a process of its own.
//
// Runs are asked for by fork_client, which stands for slipstick on the command line and below mpirun. The server ends with
// its standard input.
#include "request.h"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <vector>

#include <poll.h>
#include <sys/signalfd.h>
#include <sys/wait.h>

/// main() of source/app/main.cc, compiled under this name.
int slipstick_main(int argc, char **argv);

namespace
{
  using namespace slipstick::test;

  struct Run
  {
    int   connection;
    pid_t child;
  };

  /// In the child: becomes the process that the client stands for.
  [[noreturn]] void run(const Request &request, const std::array<int, 3> &standard, const sigset_t &mask)
  {
    for (int i = 0; i < 3; ++i)
      if (dup2(standard[i], i) < 0)
        _exit(cannot_start);
    for (int descriptor = 3; descriptor < 256; ++descriptor)
      close(descriptor);
    if (chdir(request.directory.c_str()) != 0)
      _exit(cannot_start);
    for (unsigned int i = 0; i < limited.size(); ++i)
      setrlimit(limited[i], &request.limits[i]);
    clearenv();
    for (const auto &variable : request.environment)
      putenv(strdup(variable.c_str()));
    std::vector<std::string> words{"slipstick"};
    words.insert(words.end(), request.arguments.begin(), request.arguments.end());
    std::vector<char *> argv;
    for (auto &word : words)
      argv.push_back(word.data());
    argv.push_back(nullptr);
    sigprocmask(SIG_SETMASK, &mask, nullptr);
    const int status = slipstick_main(static_cast<int>(words.size()), argv.data());
#ifdef __SANITIZE_ADDRESS__
    std::exit(status); // leaks are looked for at the exit
#else
    // MPI has ended and nothing of slipstick's is left: the finalisers of 300 libraries would only copy their pages.
    std::cout.flush();
    std::fflush(nullptr);
    _exit(status);
#endif
  }

  /// Accepts a client and forks its run.
  void accept_run(const int listener, const sigset_t &mask, std::vector<Run> &runs)
  {
    const int connection = accept4(listener, nullptr, nullptr, SOCK_CLOEXEC);
    if (connection < 0)
      return;
    std::array<int, 3> standard;
    const auto         request = receive(connection, standard);
    if (!request) // a client that was killed meanwhile
      {
        close(connection);
        return;
      }
    const pid_t child = fork();
    if (child < 0)
      {
        std::perror("fork_server: fork");
        std::exit(1);
      }
    if (child == 0)
      run(*request, standard, mask);
    for (const int descriptor : standard)
      close(descriptor);
    send_number(connection, child);
    runs.push_back({connection, child});
  }

  /// Tells the clients of the runs that have ended.
  void reap(std::vector<Run> &runs)
  {
    int status;
    for (pid_t child; (child = waitpid(-1, &status, WNOHANG)) > 0;)
      {
        const auto run = std::find_if(runs.begin(), runs.end(), [&](const Run &r) { return r.child == child; });
        if (run == runs.end())
          continue;
        send_number(run->connection, status);
        close(run->connection);
        runs.erase(run);
      }
  }
} // namespace

int main(int argc, char **argv)
{
  const int listener = argc == 2 ? listen_at(argv[1]) : -1;
  if (listener < 0)
    {
      std::perror("fork_server SOCKET");
      return 1;
    }
  std::signal(SIGPIPE, SIG_IGN);
  sigset_t ended, mask;
  sigemptyset(&ended);
  sigaddset(&ended, SIGCHLD);
  sigprocmask(SIG_BLOCK, &ended, &mask);
  const int children = signalfd(-1, &ended, SFD_NONBLOCK | SFD_CLOEXEC);

  std::puts("ready");
  std::fflush(stdout);
  std::vector<Run> runs;
  for (bool goes_on = true; goes_on;)
    {
      std::vector<pollfd> waited{{STDIN_FILENO, POLLIN, 0}, {listener, POLLIN, 0}, {children, POLLIN, 0}};
      for (const Run &run : runs)
        waited.push_back({run.connection, POLLIN, 0});
      if (poll(waited.data(), waited.size(), -1) < 0)
        continue;
      goes_on = !waited[0].revents;
      for (unsigned int i = 3; i < waited.size(); ++i)
        if (waited[i].revents) // clients say nothing more: this one was killed
          kill(runs[i - 3].child, SIGKILL);
      if (waited[2].revents)
        {
          signalfd_siginfo info;
          while (read(children, &info, sizeof info) > 0)
            ;
          reap(runs);
        }
      if (waited[1].revents)
        accept_run(listener, mask, runs);
    }
  for (const Run &run : runs)
    kill(run.child, SIGKILL);
  return 0;
}
