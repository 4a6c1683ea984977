/* Linked with programs whose main function returns nothing: they end with status 0. */
int __real_main(int count, char **arguments);
int __wrap_main(int count, char **arguments);

int __wrap_main(int count, char **arguments)
{
    __real_main(count, arguments);
    return 0;
}
