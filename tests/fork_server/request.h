// What fork_client asks of fork_server: arguments, environment, folder, limits and the three standard descriptors.
#pragma once

#include <array>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace slipstick::test
{
  constexpr int cannot_start = 125; // as env and timeout say that they could not start a command

  /// Limits that the run takes over from its client.
  constexpr std::array<decltype(RLIMIT_AS), 5> limited = {
    {RLIMIT_AS, RLIMIT_CORE, RLIMIT_CPU, RLIMIT_FSIZE, RLIMIT_NOFILE}};

  struct Request
  {
    std::vector<std::string>           arguments;   // without the name of the program
    std::vector<std::string>           environment; // NAME=VALUE
    std::string                        directory;
    std::array<rlimit, limited.size()> limits;
  };

  inline sockaddr_un address_of(const std::string &path)
  {
    sockaddr_un address = {};
    address.sun_family  = AF_UNIX;
    std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
    return address;
  }

  /// A socket that listens at @p path, or -1.
  inline int listen_at(const std::string &path)
  {
    const auto address = address_of(path);
    const int  result  = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const auto place   = reinterpret_cast<const sockaddr *>(&address);
    return bind(result, place, sizeof address) == 0 && listen(result, 64) == 0 ? result : -1;
  }

  /// A connection to the server at @p path, or -1.
  inline int connect_to(const std::string &path)
  {
    const auto address = address_of(path);
    const int  result  = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    return connect(result, reinterpret_cast<const sockaddr *>(&address), sizeof address) == 0 ? result : -1;
  }

  inline void send_number(const int connection, const int number)
  {
    // a client that is gone needs no answer
    [[maybe_unused]] const auto sent = write(connection, &number, sizeof number);
  }

  /// nullopt: the other end is gone.
  inline std::optional<int> receive_number(const int connection)
  {
    int number;
    return read(connection, &number, sizeof number) == sizeof number ? std::optional<int>(number) : std::nullopt;
  }

  /// Sends @p request with the standard descriptors; false where that fails.
  inline bool send(const int connection, const Request &request)
  {
    std::string text;
    const auto  add = [&text](const std::vector<std::string> &words) {
      for (const auto &word : words)
        text.append(word).push_back('\0');
      text.push_back('\0');
    };
    add({request.directory});
    add(request.environment);
    // an argument may be empty, hence the mark before each
    for (const auto &argument : request.arguments)
      text.append("=" + argument).push_back('\0');
    text.push_back('\0');
    text.append(reinterpret_cast<const char *>(request.limits.data()), sizeof request.limits);

    // their number and the descriptors first
    const std::size_t     size                                 = text.size();
    std::array<int, 3>    standard                             = {{STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}};
    iovec                 content                              = {const_cast<std::size_t *>(&size), sizeof size};
    alignas(cmsghdr) char control[CMSG_SPACE(sizeof standard)] = {};
    msghdr                message                              = {};
    message.msg_iov                                            = &content;
    message.msg_iovlen                                         = 1;
    message.msg_control                                        = control;
    message.msg_controllen                                     = sizeof control;
    cmsghdr *const header                                      = CMSG_FIRSTHDR(&message);
    header->cmsg_level                                         = SOL_SOCKET;
    header->cmsg_type                                          = SCM_RIGHTS;
    header->cmsg_len                                           = CMSG_LEN(sizeof standard);
    std::memcpy(CMSG_DATA(header), standard.data(), sizeof standard);
    if (sendmsg(connection, &message, 0) != sizeof size)
      return false;
    for (std::size_t done = 0; done < size;)
      {
        const auto n = write(connection, text.data() + done, size - done);
        if (n <= 0)
          return false;
        done += n;
      }
    return true;
  }

  /// What send() sent; nullopt: the client is gone.
  inline std::optional<Request> receive(const int connection, std::array<int, 3> &standard)
  {
    std::size_t           size    = 0;
    iovec                 content = {&size, sizeof size};
    alignas(cmsghdr) char control[CMSG_SPACE(sizeof standard)];
    msghdr                message = {};
    message.msg_iov               = &content;
    message.msg_iovlen            = 1;
    message.msg_control           = control;
    message.msg_controllen        = sizeof control;
    if (recvmsg(connection, &message, 0) != sizeof size)
      return std::nullopt;
    std::memcpy(standard.data(), CMSG_DATA(CMSG_FIRSTHDR(&message)), sizeof standard);
    std::string text(size, '\0');
    for (std::size_t done = 0; done < size;)
      {
        const auto n = read(connection, text.data() + done, size - done);
        if (n <= 0)
          return std::nullopt;
        done += n;
      }

    std::size_t at   = 0;
    const auto  list = [&] {
      std::vector<std::string> words;
      for (; text[at] != '\0'; at += words.back().size() + 1)
        words.emplace_back(text.c_str() + at);
      ++at;
      return words;
    };
    Request request;
    request.directory   = list().front();
    request.environment = list();
    for (const auto &argument : list())
      request.arguments.push_back(argument.substr(1));
    std::memcpy(request.limits.data(), text.data() + at, sizeof request.limits);
    return request;
  }
} // namespace slipstick::test
